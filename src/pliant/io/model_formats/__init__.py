"""Shape models: containers, and what is in them."""
