"""Polygons and triangles: their neighbours, distances, Laplacians and closest points."""
