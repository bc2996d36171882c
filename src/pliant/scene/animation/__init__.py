"""Formats of moving meshes: one a file."""
