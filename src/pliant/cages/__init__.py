"""Cages around meshes: built automatically or by hand, and checked."""
