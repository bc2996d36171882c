"""Lattices around an axis: cylinders, prisms and spheres as one block each, with their centre lines collapsed.

They are made about the z axis with radius and half height 1; a frame then puts them into place. There a point's
polar coordinates say almost exactly which parameters it has.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidDeformer
from pliant.mesh import PolygonMesh, as_points
from pliant.numerics.lattices.patch_block import Basis, PatchBlock
from pliant.space.box import box_around, thickened

Floats = NDArray[np.float64]
Kind = Literal["cylinder", "prism", "sphere"]
AXES = {"x": [1, 2, 0], "y": [2, 0, 1], "z": [0, 1, 2]}


@dataclass(frozen=True, eq=False)
class RoundFrame:
    """Where a round lattice stands, and what its parameters mean.

    Parameters
    ----------
    kind
        What it is.
    center, axes
        (3,) and (3, 3): a local point p is at ``center + axes @ p``.
    cells
        (3,) patches around, from the axis outwards, and along it.
    """

    kind: Kind
    center: Floats
    axes: Floats
    cells: tuple[int, int, int]

    def local(self, points: Floats) -> Floats:
        """(n, 3) positions relative to the unit lattice."""
        return np.asarray(np.linalg.solve(self.axes, (points - self.center).T).T)

    def seeds(self, points: Floats) -> Floats:
        """(n, 3) parameters by polar coordinates: exact in a prism, close elsewhere."""
        x, y, z = self.local(points).T
        around, outwards, along = self.cells
        sector = 2 * np.pi / around
        angle = np.mod(np.arctan2(y, x), 2 * np.pi)
        radius = np.hypot(x, y)
        if self.kind == "prism":
            side = np.minimum(np.floor(angle / sector), around - 1)
            rest = angle - side * sector
            b = np.sin(rest) / np.sin(sector)
            a = np.sin(sector - rest) / np.sin(sector)
            turn, height = side + b / (a + b), (z + 1) / 2
            radius = radius * (a + b)
        elif self.kind == "cylinder":
            turn, height = angle / sector, (z + 1) / 2
            radius = radius / ring_radius(around, turn)
        else:
            turn = angle / sector
            equator = radius / ring_radius(around, turn)
            radius = np.hypot(equator, z)
            height = 1 - np.arctan2(equator, z) / np.pi
        return np.stack([turn, outwards * radius, along * height], axis=1)


def ring_radius(count: int, turn: Floats | float = 0.5) -> Floats:
    """Distance from the axis of a uniform cubic B-spline ring on ``count`` control points at distance 1."""
    t, angle = np.mod(turn, 1.0), 2 * np.pi / count
    weights = [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
    return np.asarray(np.abs(sum(w / 6 * np.exp(1j * angle * k) for k, w in enumerate(weights, start=-1))))


def cylinder(
    target: PolygonMesh | ArrayLike, axis: str, shape: tuple[int, int, int], margin: float
) -> tuple[Floats, PatchBlock, RoundFrame]:
    """Rings of B-splines around the axis, Bézier patches outwards and along."""
    around, outwards, along = _checked(shape, "around, radial, along")
    angle = 2 * np.pi * np.arange(around) / around
    rings = np.stack([np.cos(angle), np.sin(angle)], axis=1) / ring_radius(around).min()
    return _straight("cylinder", "bspline", rings, (outwards, along), target, axis, margin)


def prism(
    target: PolygonMesh | ArrayLike, axis: str, sides: int, shape: tuple[int, int], margin: float
) -> tuple[Floats, PatchBlock, RoundFrame]:
    """Flat sides, a Bézier patch each."""
    if sides < 3:
        raise InvalidDeformer(f"a prism has three sides or more, not {sides}")
    _, outwards, along = _checked((5, *shape), "around, radial, along")
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    corners = np.stack([np.cos(angle), np.sin(angle)], axis=1) / np.cos(np.pi / sides)  # flat sides at distance 1
    parts = np.arange(3)[:, None] / 3
    rings = np.concatenate([(1 - parts) * a + parts * b for a, b in pairwise(corners)])
    return _straight("prism", "bezier", rings, (outwards, along), target, axis, margin)


def sphere(
    target: PolygonMesh | ArrayLike, axis: str, shape: tuple[int, int, int], margin: float
) -> tuple[Floats, PatchBlock, RoundFrame]:
    """Rings of B-splines around the axis, Bézier arcs from pole to pole, Bézier patches outwards."""
    around, outwards, along = _checked(shape, "around, radial, from pole to pole")
    patches = (along - 1) // 3
    arc = np.pi / patches
    reach = 4 / 3 * np.tan(arc / 4)  # of a cubic arc's inner control points along its tangents
    places = []
    for k in range(patches):
        start, end = np.pi - k * arc, np.pi - (k + 1) * arc
        a, b = (np.array([np.sin(t), np.cos(t)]) for t in (start, end))
        u, v = (np.array([-np.cos(t), np.sin(t)]) for t in (start, end))
        places += [a, a + reach * u, b - reach * v]
    profile = np.array([*places, [0.0, 1.0]])
    profile[0] = [0.0, -1.0]
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) / ring_radius(around).min()
    index = np.empty((around, outwards, along), np.int64)
    points = [np.zeros(3)]
    index[:, 0] = 0
    for j in range(1, outwards):
        part = j / (outwards - 1)
        for k, (wide, high) in enumerate(profile):
            pole = k in (0, along - 1)
            index[:, j, k] = len(points) + np.arange(around) * (not pole)
            for x, y in ring[:1] * 0 if pole else ring:
                points.append(part * np.array([wide * x, wide * y, high]))
    local = np.array(points)
    scale = 1.001 if patches > 1 else 1.02  # the arcs are no circles: by how much they may fall short
    block = PatchBlock(index, ("bspline", "bezier", "bezier"), (True, False, False))
    center, axes = _placement(target, axis, "sphere", scale * (1 + margin))
    return center + local @ axes.T, block, RoundFrame("sphere", center, axes, _cells(block))


def _straight(
    kind: Kind,
    basis: Basis,
    rings: Floats,
    counts: tuple[int, int],
    target: PolygonMesh | ArrayLike,
    axis: str,
    margin: float,
) -> tuple[Floats, PatchBlock, RoundFrame]:
    """The same rings at all heights, larger outwards; those on the axis are one control point each."""
    outwards, along = counts
    heights, parts = np.linspace(-1, 1, along), np.linspace(0, 1, outwards)
    index = np.empty((len(rings), outwards, along), np.int64)
    index[:, 0] = np.arange(along)
    index[:, 1:] = along + np.arange(len(rings) * (outwards - 1) * along).reshape(len(rings), outwards - 1, along)
    middle = np.stack([0 * heights, 0 * heights, heights], axis=1)
    shell = np.empty((len(rings), outwards - 1, along, 3))
    shell[..., :2] = rings[:, None, None] * parts[1:, None, None]
    shell[..., 2] = heights
    local = np.concatenate([middle, shell.reshape(-1, 3)])
    block = PatchBlock(index, (basis, "bezier", "bezier"), (True, False, False))
    center, axes = _placement(target, axis, kind, 1 + margin)
    return center + local @ axes.T, block, RoundFrame(kind, center, axes, _cells(block))


def _cells(block: PatchBlock) -> tuple[int, int, int]:
    a, b, c = block.cells.tolist()
    return a, b, c


def _checked(shape: tuple[int, ...], names: str) -> tuple[int, int, int]:
    if len(shape) != 3 or shape[0] < 5 or any(n < 4 or n % 3 != 1 for n in shape[1:]):
        raise InvalidDeformer(
            f"the shape ({names}) is {tuple(shape)}; it must have 5 or more control points around, and 4, 7, 10 ... "
            "along the other two"
        )
    return int(shape[0]), int(shape[1]), int(shape[2])


def _placement(target: PolygonMesh | ArrayLike, axis: str, kind: Kind, growth: float) -> tuple[Floats, Floats]:
    """Centre and axes of the unit shape that holds a target: an ellipse as wide and deep as its bounding box is."""
    if axis not in AXES:
        raise InvalidDeformer(f"axis is {axis!r}; it must be 'x', 'y' or 'z'")
    if not np.isfinite(growth) or growth < 1:
        raise InvalidDeformer("the margin must be finite and not negative")
    frame = np.eye(3)[:, AXES[axis]]
    origin, extent = box_around(target, frame, 0.0)
    center = origin + frame @ (extent / 2)
    half = thickened(extent) / 2
    local = np.abs((as_points(target) - center) @ frame) / half
    wide = np.linalg.norm(local if kind == "sphere" else local[:, :2], axis=1).max(initial=1e-3)
    half *= growth * np.array([wide, wide, wide if kind == "sphere" else 1.0])
    return center, frame * half
