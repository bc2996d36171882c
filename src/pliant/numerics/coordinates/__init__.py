"""Coordinates of points in cages of triangles, and which points lie inside."""
