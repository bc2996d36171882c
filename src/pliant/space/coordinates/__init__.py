"""Coordinates of points with respect to a cage, one kind a file."""
