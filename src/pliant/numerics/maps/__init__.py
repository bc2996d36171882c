"""Maps of space at many points: sections, radial sums, inverses, normals."""
