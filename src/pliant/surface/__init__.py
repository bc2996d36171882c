"""Surface deformers: a mesh edits itself."""
