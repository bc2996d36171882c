"""Polynomials on grids of cells: the sums, inverses and bounds of lattices."""
