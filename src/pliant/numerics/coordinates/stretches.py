"""Normals of deformed triangles, as long as the triangles were stretched (Lipman, Levin & Cohen-Or 2008, eq. 9).

For edges u, v at rest and u', v' now, s² = (|u'|² |v|² - 2 (u'.v') (u.v) + |v'|² |u|²) / 8A²: the mean of the squared
principal stretches, and n' s is linear under similarities, which is why details keep their shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class StretchedNormals:
    """s n' of triangles that are deformed from a rest shape.

    Parameters
    ----------
    points, triangles
        (p, 3) rest positions, (t, 3) vertices.
    """

    def __init__(self, points: Floats, triangles: Indices) -> None:
        u, v = _edges(points, triangles)
        self.triangles = triangles
        self._uu, self._uv, self._vv = _dot(u, u), _dot(u, v), _dot(v, v)
        self._size = 2 * np.maximum(self._uu * self._vv - self._uv**2, 1e-300)  # 8 A^2

    def at(self, points: Floats, chosen: Indices | slice = slice(None)) -> Floats:
        """(t, 3) s n' for (p, 3) positions; zero where a triangle has collapsed to a line."""
        u, v = _edges(points, self.triangles[chosen])
        stretch = np.sqrt(np.maximum(self._square(u, v, chosen), 0.0))
        return np.asarray(_unit(np.cross(u, v))[0] * stretch[:, None])

    def pushed(self, points: Floats, d_points: Floats) -> Floats:
        """(t, 3) how s n' changes with the positions."""
        u, v = _edges(points, self.triangles)
        du, dv = _edges(d_points, self.triangles)
        normal, length = _unit(np.cross(u, v))
        stretch = np.sqrt(np.maximum(self._square(u, v), 1e-300))
        turned = np.cross(du, v) + np.cross(u, dv)
        turned -= normal * _dot(normal, turned)[:, None]
        one, two = self._slopes(u, v)
        grown = (_dot(one, du) + _dot(two, dv)) / stretch
        return np.asarray(turned * (stretch / length)[:, None] + normal * grown[:, None])

    def pulled(self, points: Floats, gradient: Floats) -> Floats:
        """(p, 3) the transpose of :meth:`pushed`."""
        u, v = _edges(points, self.triangles)
        normal, length = _unit(np.cross(u, v))
        stretch = np.sqrt(np.maximum(self._square(u, v), 1e-300))
        side = gradient - normal * _dot(normal, gradient)[:, None]
        side *= (stretch / length)[:, None]
        along = _dot(normal, gradient) / stretch
        one, two = self._slopes(u, v)
        to_u = np.cross(v, side) + one * along[:, None]
        to_v = np.cross(side, u) + two * along[:, None]
        result = np.zeros_like(points)
        for corner, part in ((0, -to_u - to_v), (1, to_u), (2, to_v)):
            np.add.at(result, self.triangles[:, corner], part)
        return result

    def _square(self, u: Floats, v: Floats, chosen: Indices | slice = slice(None)) -> Floats:
        mixed = _dot(u, u) * self._vv[chosen] - 2 * _dot(u, v) * self._uv[chosen] + _dot(v, v) * self._uu[chosen]
        return np.asarray(mixed / self._size[chosen])

    def _slopes(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Half of the derivatives of s² by u' and v'."""
        one = (u * self._vv[:, None] - v * self._uv[:, None]) / self._size[:, None]
        two = (v * self._uu[:, None] - u * self._uv[:, None]) / self._size[:, None]
        return one, two


def _edges(points: Floats, triangles: Indices) -> tuple[Floats, Floats]:
    first = points[triangles[:, 0]]
    return points[triangles[:, 1]] - first, points[triangles[:, 2]] - first


def _unit(vectors: Floats) -> tuple[Floats, Floats]:
    length = np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)
    return vectors / length[:, None], length


def _dot(one: Floats, two: Floats) -> Floats:
    return np.asarray(np.einsum("ti,ti->t", one, two))
