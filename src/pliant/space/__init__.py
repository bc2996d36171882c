"""Maps of R^3, whatever the shape is made of."""
