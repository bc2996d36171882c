"""What a deformation does to the space around a point: numbers from its Jacobian."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer, Target
from pliant.errors import NotDifferentiable
from pliant.mesh import as_points


def volume_ratio(deformer: Deformer, points: Target) -> NDArray[np.float64]:
    """(n,) how a deformation changes volume around points: det J.

    One where volume is kept, below zero where the map turns space inside out (Barr 1984, eq. 4).

    Parameters
    ----------
    deformer
        A map of R^3.
    points
        (n, 3) positions before the deformation, or a mesh for its vertices.

    Raises
    ------
    NotDifferentiable
        The deformer is defined on a surface only.
    """
    return np.asarray(np.linalg.det(_jacobian(deformer, points)))


def principal_strains(deformer: Deformer, points: Target) -> NDArray[np.float64]:
    """(n, 3) principal strains, ascending: the eigenvalues of the Green-Lagrange tensor (JᵀJ - I) / 2.

    Zero where the map is a rigid motion; (s² - 1) / 2 where it stretches by s. The tensor does not see rotations.

    Parameters
    ----------
    deformer
        A map of R^3.
    points
        (n, 3) positions before the deformation, or a mesh for its vertices.

    Raises
    ------
    NotDifferentiable
        The deformer is defined on a surface only.
    """
    jacobian = _jacobian(deformer, points)
    return np.asarray(np.linalg.eigvalsh((np.swapaxes(jacobian, 1, 2) @ jacobian - np.eye(3)) / 2))


def _jacobian(deformer: Deformer, points: Target) -> NDArray[np.float64]:
    if not isinstance(deformer, SpaceDeformer):
        name = type(deformer).__name__
        raise NotDifferentiable(f"{name} is no map of R^3 and has no Jacobian: choose a space deformer")
    return deformer.jacobian(as_points(points))
