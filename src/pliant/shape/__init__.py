"""Statistics of shape: Gaussian processes, the models that they make of a shape, and fitting those."""
