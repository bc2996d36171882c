"""Faces: from a photograph to a textured mesh, its caricature, and handles that move it."""
