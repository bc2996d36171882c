"""What can be said of det J without cells: affine, placed, inverted and composed maps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.field.certificate import Certificate
from pliant.mesh import Points
from pliant.numerics.polynomial_cells import determinant, rational
from pliant.space.affine import Affine
from pliant.space.inverse import Inverse
from pliant.space.placed import Placed

Prove = Callable[[SpaceDeformer], Certificate]


def certificate_by_rule(deformer: SpaceDeformer, prove: Prove) -> Certificate | None:
    """What follows from the kind of a map and from proofs about its parts; None if nothing does."""
    if isinstance(deformer, Affine):
        return _affine(deformer)
    if isinstance(deformer, Placed):
        return _placed(deformer, prove(deformer.deformer))
    if isinstance(deformer, Inverse):
        return _inverted(deformer, prove(deformer.deformer))
    return None


def _affine(deformer: Affine) -> Certificate:
    """det A, in rational arithmetic."""
    exact = determinant(rational(deformer.linear))
    value = float(exact)
    lower, upper = float(np.nextafter(value, -inf)), float(np.nextafter(value, inf))
    if exact <= 0:
        return Certificate("folds", lower, upper, value, value, np.zeros(3), exact != 0, "exact")
    return Certificate("fold-free", max(lower, 0.0), upper, value, value, np.zeros(3), True, "exact")


def _placed(deformer: Placed, inner: Certificate) -> Certificate:
    """A J A^-1 has the determinant of J."""
    return replace(inner, point=_carried(deformer.frame, inner.point))


def _inverted(deformer: Inverse, inner: Certificate) -> Certificate:
    """The determinant of J^-1 is 1 / det J; a map that folds has no inverse."""
    if inner.status != "fold-free":
        return replace(inner, lower=-inf, upper=inf, least=None, greatest=None, status="undecided", method="sampled")
    assert inner.least is not None
    assert inner.greatest is not None
    lower = float(np.nextafter(1 / inner.upper, -inf))
    upper = float(np.nextafter(1 / inner.lower, inf))
    point = _carried(deformer.deformer, inner.point)
    return replace(inner, lower=lower, upper=upper, least=1 / inner.greatest, greatest=1 / inner.least, point=point)


def _carried(deformer: SpaceDeformer, point: Points | None) -> Points | None:
    return None if point is None else deformer(point[None])[0]
