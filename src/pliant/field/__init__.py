"""Looking at a deformation: grids, arrows, Jacobians, volume."""
