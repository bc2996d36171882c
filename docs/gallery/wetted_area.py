"""A pod of the same volume with less skin.

A gradient method moves 80 control points so that the area of the surface, which friction acts on, falls and the volume
stays: gradients are pulled back through the binding. No control point goes farther than 0.4 of its spacing, so that
nothing can fold (Choi & Lee 2000). The number is how far the volume is off, relatively.
"""

from pathlib import Path

import numpy as np
from PIL import Image
from scipy.optimize import minimize
from shapes import globe

import pliant as pl


def main(out: Path, size: tuple[int, int] = (760, 640)) -> float:
    pod = globe(40, 48)
    x, y, z = pod.points.T
    pod = pod.with_points(np.column_stack([2 * x, 0.55 * y, 0.8 * z + 0.3 * np.cos(2.5 * x)]))
    lattice = pl.BSplineFFD.around(pod, shape=(7, 4, 4), margin=0.1)
    bound, whole = lattice.bind(pod), pl.volume(pod)
    free = np.zeros(lattice.rest.shape, bool)
    free[1:-1, :, :, 1:] = True  # the ends are held, and nothing moves along the pod

    def pose(move):
        controls = lattice.rest.copy()
        controls[free] += move
        return controls, pod.with_points(bound.deform(controls))

    def pulled(move, value):
        return bound.vjp(pose(move)[0], value(pose(move)[1]))[free]

    kept = {"type": "eq", "fun": lambda move: pl.volume(pose(move)[1]) / whole - 1}
    kept["jac"] = lambda move: pulled(move, pl.volume_gradient) / whole
    reach = np.broadcast_to(0.4 * lattice.spacing, lattice.rest.shape)[free]
    way = {"bounds": list(zip(-reach, reach, strict=True)), "constraints": kept, "options": {"maxiter": 40}}
    found = minimize(lambda m: pl.area(pose(m)[1]), 0 * reach, jac=lambda m: pulled(m, pl.area_gradient), **way)
    panels = [pl.render(pod, lattice.moved(pose(move)[0]), size=size, view=(1, -1.6, 0.7)) for move in (0, found.x)]
    Image.fromarray(np.hstack(panels)).save(out / "wetted_area.png", optimize=True)
    return abs(pl.volume(pose(found.x)[1]) / whole - 1)
