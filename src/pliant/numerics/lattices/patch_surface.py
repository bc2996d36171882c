"""A Bézier surface over a plane: its tangents and normals, at many parameters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.lattices.bases import bernstein

Floats = NDArray[np.float64]


class PatchSurface(NamedTuple):
    """The surface at k parameters: displacement, tangents, normal, its length before it was a unit; second tangents."""

    shift: Floats
    s: Floats
    t: Floats
    normal: Floats
    length: Floats
    ss: Floats
    st: Floats
    tt: Floats

    @classmethod
    def at(
        cls, edges: Floats, plane: Floats, parameters: Floats, moves: Floats, *, second: bool = False
    ) -> PatchSurface:
        """The surface over (3, 2) edges of a plane with unit normal (3,), whose (l, m, 1, 3) control points moved."""
        shift = bernstein_sum(parameters, moves, 0, 0)
        s = edges[:, 0] + bernstein_sum(parameters, moves, 1, 0)
        t = edges[:, 1] + bernstein_sum(parameters, moves, 0, 1)
        cross = np.cross(s, t)
        length = np.linalg.norm(cross, axis=1, keepdims=True)
        size = np.linalg.norm(s, axis=1, keepdims=True), np.linalg.norm(t, axis=1, keepdims=True)
        proper = length > 1e-12 * size[0] * size[1]
        proper &= (size[0] > 1e-12 * np.linalg.norm(edges[:, 0])) & (size[1] > 1e-12 * np.linalg.norm(edges[:, 1]))
        length = np.where(proper, length, np.inf)
        normal = np.where(proper, cross / length, plane)
        twice = [bernstein_sum(parameters, moves, *order) if second else shift for order in ((2, 0), (1, 1), (0, 2))]
        return cls(shift, s, t, normal, length, *twice)

    def turned(self, d_s: Floats, d_t: Floats) -> Floats:
        """How the normal changes when the tangents change."""
        change = np.cross(d_s, self.t) + np.cross(self.s, d_t)
        return self.across(change) / self.length

    def across(self, vectors: Floats) -> Floats:
        """Vectors without their part along the normal."""
        return np.asarray(vectors - np.einsum("ij,ij->i", vectors, self.normal)[:, None] * self.normal)


def bernstein_sum(parameters: Floats, values: Floats, s_order: int, t_order: int) -> Floats:
    """(k, 3) a derivative of the Bernstein sum of (l, m, 1, 3) values."""
    first = _basis(values.shape[0], parameters[:, 0], s_order)
    along = (first @ values.reshape(len(values), -1)).reshape(len(parameters), values.shape[1], 3)
    return np.asarray(np.einsum("kj,kjc->kc", _basis(values.shape[1], parameters[:, 1], t_order), along))


def bernstein_transpose(
    parameters: Floats, vectors: Floats, shape: tuple[int, ...], s_order: int, t_order: int
) -> Floats:
    """(l, m, 1, 3) the transpose of :func:`_sum` applied to (k, 3) vectors."""
    first, second = _basis(shape[0], parameters[:, 0], s_order), _basis(shape[1], parameters[:, 1], t_order)
    spread = (second[:, :, None] * vectors[:, None]).reshape(len(vectors), -1)
    return np.asarray((first.T @ spread).reshape(shape))


def _basis(count: int, t: Floats, order: int) -> Floats:
    """(k, count) a derivative of the Bernstein polynomials: the hodograph's."""
    if order > count - 1:
        return np.zeros((len(t), count))
    degree = count - 1
    factor = np.prod(np.arange(degree, degree - order, -1), dtype=np.float64)
    return np.asarray(factor * bernstein(degree - order, t) @ np.diff(np.eye(count), n=order, axis=0))
