"""What can be said of det J without cells: of affine maps, of those that keep volume, of maps made of others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import inf

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.field.certificate import Certificate, Status
from pliant.mesh import Points
from pliant.numerics.lattices.polynomial_cells import determinant, rational
from pliant.space.affine import Affine
from pliant.space.compose import Composition
from pliant.space.inverse import Inverse
from pliant.space.placed import Placed
from pliant.space.scale import Scale
from pliant.space.sine import Sine
from pliant.space.squash import Squash
from pliant.space.twist import Twist
from pliant.space.wave import Wave

Prove = Callable[[SpaceDeformer], Certificate]


def certificate_by_rule(deformer: SpaceDeformer, prove: Prove) -> Certificate | None:
    """What follows from the kind of a map and from proofs about its parts; None if nothing does."""
    if isinstance(deformer, Affine):
        return _constant(determinant(rational(deformer.linear)))
    if isinstance(deformer, Scale):
        return _constant(Fraction(deformer.x) * Fraction(deformer.y) * Fraction(deformer.z))
    if isinstance(deformer, Twist | Squash | Sine | Wave):
        return _constant(Fraction(1))  # by construction; all are undone section by section
    if isinstance(deformer, Placed):
        return _placed(deformer, prove(deformer.deformer))
    if isinstance(deformer, Inverse):
        return _inverted(deformer, prove(deformer.deformer))
    if isinstance(deformer, Composition):
        return _composed([prove(part) for part in deformer.deformers])
    return None


def _constant(exact: Fraction) -> Certificate:
    """The same det J everywhere, known exactly: such a map is a bijection unless det J = 0."""
    value = float(exact)
    lower, upper = (value, value) if exact == Fraction(value) else _widened(value, value)
    status: Status = "fold-free" if exact > 0 else "folds"
    return Certificate(status, lower, upper, value, value, np.zeros(3), exact != 0, "exact")


def _widened(lower: float, upper: float) -> tuple[float, float]:
    """Bounds that stay bounds however their computation was rounded, once; positive ones stay positive."""
    below = float(np.nextafter(lower, -inf))
    return max(below, 5e-324) if lower > 0 else below, float(np.nextafter(upper, inf))


def _placed(deformer: Placed, inner: Certificate) -> Certificate:
    """A J A^-1 has the determinant of J."""
    return replace(inner, point=_carried(deformer.frame, inner.point))


def _inverted(deformer: Inverse, inner: Certificate) -> Certificate:
    """The determinant of J^-1 is 1 / det J; a map that folds has no inverse."""
    if inner.status != "fold-free":
        return replace(inner, lower=-inf, upper=inf, least=None, greatest=None, status="undecided", method="sampled")
    assert inner.least is not None
    assert inner.greatest is not None
    lower, upper = _widened(1 / inner.upper, 1 / inner.lower)
    point = _carried(deformer.deformer, inner.point)
    return replace(inner, lower=lower, upper=upper, least=1 / inner.greatest, greatest=1 / inner.least, point=point)


def _composed(parts: list[Certificate]) -> Certificate | None:
    """The determinant of a product is the product: its bounds are among the products of the parts' bounds."""
    lower, upper = 1.0, 1.0
    for part in parts:
        if not np.isfinite([part.lower, part.upper]).all():
            return None
        products = [one * other for one in (lower, upper) for other in (part.lower, part.upper)]
        lower, upper = _widened(min(products), max(products))
    injective = True if all(part.injective for part in parts) else None
    status: Status = "fold-free" if lower > 0 else "undecided"
    halved = sum(part.subdivisions for part in parts)
    return Certificate(status, lower, upper, injective=injective, method="bounds", subdivisions=halved)


def _carried(deformer: SpaceDeformer, point: Points | None) -> Points | None:
    return None if point is None else deformer(point[None])[0]
