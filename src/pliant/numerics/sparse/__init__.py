"""Sparse Cholesky: orders, elimination, fronts and solves."""
