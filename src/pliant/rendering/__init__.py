"""Pictures of shapes and of what deforms them, drawn off-screen."""
