"""Images, and how they lie in space."""
