"""Natural-neighbour coordinates, by Voronoi cells that are cut out one by one."""
