"""The exact volume of a deformed lattice."""

from __future__ import annotations

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidDeformer
from pliant.field.certifying import determinants_of, polynomial_cells
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.placed import Placed

_AT_ONCE = 512  # cells looked at together


def deformed_volume(deformer: SpaceDeformer) -> float:
    """The volume of a lattice's block after the deformation: the integral of det J over the block, in closed form.

    The mean of a polynomial over a cell is the mean of its Bernstein coefficients. Where the map folds, what is
    inside out counts as negative.

    Parameters
    ----------
    deformer
        A :class:`~pliant.BSplineFFD`, whose block is the box that its control points span at rest, or a
        :class:`~pliant.BezierFFD`, whose block is its parallelepiped; also one that was placed.

    Returns
    -------
    float
        In the cube of the lattice's unit.

    Raises
    ------
    InvalidDeformer
        No such lattice, or one whose block is flat.
    """
    if isinstance(deformer, Placed):
        return abs(float(np.linalg.det(deformer.frame.linear))) * deformed_volume(deformer.deformer)
    cells = polynomial_cells(deformer)
    if cells is None:
        raise InvalidDeformer(f"a {type(deformer).__name__} is no lattice of polynomials: it has no block")
    counts = np.array(cells.counts)
    first, last = np.zeros(3, np.int64), counts
    if isinstance(deformer, BSplineFFD):
        if min(deformer.shape) < 2:
            raise InvalidDeformer(f"a lattice of shape {deformer.shape} has no volume: two control points an axis do")
        first = (counts - (np.array(deformer.shape) - 1)) // 2
        last = counts - first
    beyond = int(np.prod(last - first) - np.prod(np.minimum(last, counts) - np.maximum(first, 0)))
    first, last = np.maximum(first, 0), np.minimum(last, counts)
    index = np.stack(np.meshgrid(*map(np.arange, first, last), indexing="ij"), axis=-1).reshape(-1, 3)
    inside = np.asarray(np.ravel_multi_index(tuple(index.T), tuple(counts)), np.int64).reshape(-1)
    polynomials = determinants_of(cells)
    total = beyond * float(polynomials.at_rest)  # an edge "identity" ends the support inside the block
    for start in range(0, len(inside), _AT_ONCE):
        coefficients, _ = polynomials.coefficients(inside[start : start + _AT_ONCE])
        total += float(coefficients.mean(axis=(1, 2, 3)).sum())
    return total / abs(float(np.linalg.det(cells.frame[:, :3])))
