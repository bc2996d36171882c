"""Rotations: the nearest ones, their quaternions, and energies of what is nearly rigid."""
