"""Free-form deformation from the formula, and why splines replaced it.

On the left a vase in a lattice. In the middle one control point is pulled in Sederberg & Parry's Bézier lattice: all of
the vase follows. On the right it is pulled in a B-spline lattice: only what is near does. The number is how far twelve
lines of NumPy, written from the formula, are from the library: nothing.
"""

from math import comb
from pathlib import Path

import numpy as np
from PIL import Image

import pliant as pl
from pliant import examples


def naive(points, low, high, controls):
    """Sederberg & Parry (1986), eq. 2, word by word."""
    count = np.array(controls.shape[:3])
    s = (points - low) / (high - low)
    weights = []
    for axis, degree in enumerate(count - 1):
        i = np.arange(degree + 1)
        binomials = np.array([comb(degree, k) for k in i])
        weights.append(binomials * s[:, axis, None] ** i * (1 - s[:, axis, None]) ** (degree - i))
    return np.einsum("pi,pj,pk,ijkc->pc", *weights, controls)


def main(out: Path, size: tuple[int, int] = (540, 640)) -> float:
    vase = examples.vase()
    bezier, spline = (kind.around(vase, shape=(4, 4, 6)) for kind in (pl.BezierFFD, pl.BSplineFFD))
    panels, poses = [], []
    for lattice, pull in ((bezier, 0), (bezier, 1), (spline, 1)):
        controls = lattice.rest.copy()
        controls[3, 1, 3] += pull * np.array([120.0, -60.0, 30.0])
        poses.append(lattice.moved(controls))
        panels.append(pl.render(vase, poses[-1], color="displacement", limits=(0, 25), legend=False, size=size))
    Image.fromarray(np.hstack(panels)).save(out / "from_the_formula.png", optimize=True)
    ours = naive(vase.points, bezier.rest[0, 0, 0], bezier.rest[-1, -1, -1], poses[1].controls)
    return float(np.abs(ours - poses[1](vase.points)).max() / vase.diagonal)
