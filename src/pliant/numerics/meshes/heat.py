"""Distances by the heat method on the triangles as they are, with two factorizations of one pattern.

Heat that spreads from a source for a short time falls fastest straight away from it; the function whose gradient points
that way with length one is the distance (Crane, Weischedel & Wardetzky 2013, algorithm 1). The stiffness GᵀAG of linear
finite elements is never indefinite, obtuse triangles or not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array

from pliant.numerics.meshes.gradients import plane_gradients
from pliant.numerics.meshes.laplacians import masses
from pliant.numerics.sparse.sparse_cholesky import Cholesky

Floats = NDArray[np.float64]

_ANCHOR = 1e-9  # of the mean stiffness: holds the constant that Poisson's equation leaves free


class HeatDistances:
    """Distances on a connected surface: what depends on the surface only is computed once.

    Parameters
    ----------
    points, triangles
        (n, 3) and (t, 3); each point is used by a triangle.

    Raises
    ------
    SingularSystem
        The triangles have no area to speak of.
    """

    def __init__(self, points: Floats, triangles: NDArray[np.int32]) -> None:
        one, two = (points[triangles[:, i]] - points[triangles[:, 0]] for i in (1, 2))
        area = np.linalg.norm(np.cross(one, two), axis=1) / 2
        self._gradient = plane_gradients(points, triangles)
        self._divergence = csr_array((diags_array(np.repeat(area, 3)) @ self._gradient).T)
        stiffness = csr_array(self._divergence @ self._gradient)
        mass = masses(points, triangles)
        time = float(np.mean(np.linalg.norm(one, axis=1))) ** 2
        self._heat = Cholesky(diags_array(mass) + time * stiffness)
        anchor = _ANCHOR * stiffness.diagonal().mean() / mass.mean()
        self._poisson = self._heat.refactored(stiffness + diags_array(anchor * mass))

    def __call__(self, sources: NDArray[np.integer]) -> Floats:
        """(n,) how far each point is from the nearest source, about."""
        hot = np.zeros(self._heat.size)
        hot[sources] = 1.0
        slopes = (self._gradient @ self._heat.solve(hot)).reshape(-1, 3)
        steepness = np.linalg.norm(slopes, axis=1, keepdims=True)
        away = -np.divide(slopes, steepness, out=np.zeros_like(slopes), where=steepness > 0)
        rising = self._poisson.solve(self._divergence @ away.reshape(-1))
        return np.asarray(rising - rising[sources].mean())
