"""Shapes and scenes to try the studio on, made on the spot."""
