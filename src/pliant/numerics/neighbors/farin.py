"""Farin's (1990) C1 interpolant over natural neighbours: a cubic Bézier simplex, in closed form.

f = sum_ijk l_i l_j l_k b_ijk over ordered triples of neighbours, with b_iii = z_i, b_iij = z_i + g_i.(p_j - p_i) / 3,
and b_ijk a quarter of the sum of the six b_iij minus a sixth of z_i + z_j + z_k. As the coordinates l sum to one, the
triple sum is linear in the sites' values z and gradients g:

    f = sum_i a_i z_i + sum_i b_i . g_i,    a_i = l_i (1 + l_i - Q),
    b_i = l_i / 2 ((1 + l_i) (x - p_i) - (q - Q p_i)),    Q = sum_j l_j^2,  q = sum_j l_j^2 p_j,  x = sum_j l_j p_j.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from pliant.numerics.neighbors.natural_neighbors import Coordinates

Floats = NDArray[np.float64]


class FarinForm:
    """The weights of values and gradients at some points.

    Parameters
    ----------
    coordinates
        Of the points, with gradients if :meth:`differentiated` is wanted.
    sites
        (m, 3) positions.
    """

    def __init__(self, coordinates: Coordinates, sites: Floats) -> None:
        self._of, self._sites = coordinates, sites
        self._rows = np.repeat(np.arange(len(coordinates.starts) - 1), np.diff(coordinates.starts))
        values, at = coordinates.values[:, None], sites[coordinates.sites]
        self._x, self._q = self._sum(values * at), self._sum(values**2 * at)
        self._square = self._sum(values**2)

    def weights(self) -> tuple[Floats, Floats]:
        """(e,) and (e, 3): the a_i and b_i of each coordinate."""
        l, rows = self._of.values[:, None], self._rows  # noqa: E741
        square = self._square[rows]
        return (l * (1 + l - square))[:, 0], l / 2 * self._bracket()

    def differentiated(self) -> tuple[Floats, Floats]:
        """(e, 3) and (e, 3, 3): the gradients of a_i; of b_i, row = component."""
        l, rows, slope = self._of.values[:, None], self._rows, self._of.gradients  # noqa: E741
        at = self._sites[self._of.sites]
        square, d_square = self._square[rows], 2 * self._sum(l * slope)[rows]
        d_a = slope * (1 + l - square) + l * (slope - d_square)
        d_x = self._sum(at[:, :, None] * slope[:, None, :])[rows]
        d_q = 2 * self._sum((l * at)[:, :, None] * slope[:, None, :])[rows]
        x = self._x[rows] - at
        d_bracket = x[:, :, None] * slope[:, None, :] + (1 + l)[:, :, None] * d_x - d_q
        d_bracket += at[:, :, None] * d_square[:, None, :]
        return d_a, self._bracket()[:, :, None] / 2 * slope[:, None, :] + l[:, :, None] / 2 * d_bracket

    def _bracket(self) -> Floats:
        l, rows, at = self._of.values[:, None], self._rows, self._sites[self._of.sites]  # noqa: E741
        return np.asarray((1 + l) * (self._x[rows] - at) - (self._q[rows] - self._square[rows] * at))

    def _sum(self, terms: Floats) -> Floats:
        """Sums over each point's row."""
        sums = np.zeros((len(self._of.starts) - 1, *terms.shape[1:]))
        if len(terms):
            filled = np.diff(self._of.starts) > 0
            sums[filled] = np.add.reduceat(terms, self._of.starts[:-1][filled])
        return sums


def gradient_fit(sites: Floats, neighbors: list[NDArray[np.int64]]) -> csr_array:
    """(3 m, m) what fits gradients to values at sites, by least squares weighted with inverse square distances.

    A quadratic through the site is fitted where its neighbours determine one, so that gradients of quadratics are
    exact; else a linear function, the shortest gradient where even that is not determined.

    Parameters
    ----------
    sites
        (m, 3) positions.
    neighbors
        For each site those that its gradient is fitted to.
    """
    rows, columns, entries = [], [], []
    for i, near in enumerate(neighbors):
        if not len(near):
            continue
        apart = sites[near] - sites[i]
        length = np.linalg.norm(apart, axis=1)
        reach = length.max()
        fit = _fitted(apart / reach, reach / length) / reach
        rows.append(np.repeat(3 * i + np.arange(3), len(near) + 1))
        columns.append(np.tile(np.append(near, i), 3))
        entries.append(np.column_stack([fit, -fit.sum(axis=1)]).reshape(-1))
    if not rows:
        return csr_array((3 * len(sites), len(sites)))
    parts = np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))
    return csr_array(parts, shape=(3 * len(sites), len(sites)))


def _fitted(apart: Floats, weights: Floats) -> Floats:
    """(3, k) what makes a gradient from differences of values at (k, 3) places."""
    x, y, z = apart.T
    design = np.column_stack([apart, x * x, y * y, z * z, x * y, y * z, z * x]) * weights[:, None]
    if len(apart) >= 9:
        size = np.linalg.norm(design, axis=0)
        if (size > 1e-6).all() and np.linalg.cond(design / size) < 1e3:
            return np.asarray(np.linalg.pinv(design)[:3] * weights)
    return np.asarray(np.linalg.pinv(design[:, :3], rcond=1e-6) * weights)
