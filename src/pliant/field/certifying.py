"""Proofs that a deformation does not fold, or the point where it does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter, NonFiniteResult, NotDifferentiable
from pliant.field.certificate import Certificate, Status
from pliant.field.grids import checked_box
from pliant.field.polynomial_range import Extreme, Range, determinant_range
from pliant.field.rules import certificate_by_rule
from pliant.mesh import Points
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.determinants import Determinants
from pliant.numerics.lattices.polynomial_cells import PolynomialCells

_SAMPLES = 32  # along each axis, where nothing can be proved
_INSIDE = 1e-9  # of a cell: its faces belong to its neighbours too, where the Jacobian may be another


def certify(
    deformer: Deformer,
    *,
    budget: int = 20_000,
    tolerance: float = 0.01,
    bounds: tuple[ArrayLike, ArrayLike] | None = None,
    progress: Callable[[float], object] | None = None,
) -> Certificate:
    """Prove that a map does not fold: that det J > 0 everywhere.

    For lattices of polynomials (:class:`~pliant.BSplineFFD`, :class:`~pliant.BezierFFD`) det J is a polynomial in
    each cell. Its Bernstein coefficients bound it; where they do not decide, cells are halved. All roundings are
    bounded and the bounds widened by them, so that "fold-free" is a proof about the map with exactly the numbers
    stored; a point where the map folds is confirmed in rational arithmetic. Bounds hold in all of space: in the cells
    beyond the lattice that its last control points reach, and outside, where det J = det A. (Bézier lattices with
    another ``outside`` than ``"identity"`` are looked at inside only.)

    det J > 0 means that the map is injective around every point. It is injective as a whole, :attr:`Certificate
    .injective`, where it is also continuous in all of space: displacements are bounded, so that the map is proper, and
    a proper local homeomorphism of R^3 is a homeomorphism (Hadamard's theorem; Krantz & Parks, *The Implicit Function
    Theorem*, 2002, sec. 6.2). Where derivatives jump, at the rim of a Bézier lattice, the same follows from the
    mapping degree: it is one, and every pre-image counts positively.

    Where det J is constant (affine maps, scales, twists, squashes, waves) it is known exactly; placed and inverted
    maps are decided from what they place or invert, compositions from the products of their parts' bounds. All others
    are only sampled: they are never proved fold-free.

    Parameters
    ----------
    deformer
        A map of R^3.
    budget
        How many boxes may be halved, after one look at each cell.
    tolerance
        How close to the values found the bounds should come, relative to these.
    bounds
        Lowest and highest corner, (3,) each, of the box to sample where nothing can be proved. None = the box of the
        control points at rest, where there are some.
    progress
        Is told, while boxes are halved, what part of the budget is spent, from 0 to 1; anew for each part of a
        composition. What it raises ends the search.

    Raises
    ------
    InvalidParameter
        A budget below zero, a tolerance that is not between 0 and 1, an empty box.
    NotDifferentiable
        The deformer is defined on a surface only.
    NonFiniteResult
        The displacements are so large that det J overflows.
    """
    most, part = as_numbers("budget", budget, InvalidParameter), as_numbers("tolerance", tolerance, InvalidParameter)
    if most.shape or part.shape or not most >= 0 or not 0 < part < 1:
        raise InvalidParameter(f"budget is 0 or more, tolerance between 0 and 1; given: {budget}, {tolerance}")
    if not isinstance(deformer, SpaceDeformer):
        raise NotDifferentiable(f"{type(deformer).__name__} is no map of R^3 and has no Jacobian: nothing to certify")
    if bounds is not None:
        checked_box(bounds)

    def prove(part: SpaceDeformer) -> Certificate:
        cells = polynomial_cells(part)
        if cells is not None:
            return _certificate(cells, budget, tolerance, progress)
        return certificate_by_rule(part, prove) or Certificate("undecided", method="sampled")

    proof = prove(deformer)
    return _sampled(deformer, proof, bounds) if proof.status == "undecided" and proof.least is None else proof


def polynomial_cells(deformer: Deformer) -> PolynomialCells | None:
    """The cells of a deformer that offers them; None for others."""
    offered = getattr(deformer, "polynomial_cells", None)
    return None if offered is None else offered()


def determinants_of(cells: PolynomialCells) -> Determinants:
    """det J in each cell.

    Raises
    ------
    NonFiniteResult
        Displacements that are too large or a lattice that is too small for floating-point numbers.
    """
    cause = "det J leaves the floating-point numbers: the displacements are too large for the lattice"
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            polynomials = Determinants(cells)
        except (OverflowError, ZeroDivisionError) as error:
            raise NonFiniteResult(cause) from error
        if not np.isfinite(np.concatenate(polynomials.ranges(np.arange(np.prod(cells.counts))))).all():
            raise NonFiniteResult(cause)
    return polynomials


def _certificate(
    cells: PolynomialCells, budget: int, tolerance: float, progress: Callable[[float], object] | None
) -> Certificate:
    found = determinant_range(determinants_of(cells), budget, tolerance, progress)
    folds = found.lower <= 0 and _is_fold(cells, found.least)
    fold_free = found.lower > 0
    return Certificate(
        "fold-free" if fold_free else "folds" if folds else "undecided",
        found.lower,
        found.upper,
        found.least.value,
        found.greatest.value,
        _place(cells, found.least),
        _is_injective(cells, found),
        "coefficients",
        found.halved,
    )


def _is_fold(cells: PolynomialCells, least: Extreme) -> bool:
    """Whether det J <= 0 where its least value was found: by its error bound, or exactly."""
    if abs(least.value) > least.error or least.cell < 0:
        return least.value <= 0
    return cells.exact_determinant(least.cell, least.local) <= 0


def _is_injective(cells: PolynomialCells, found: Range) -> bool | None:
    if not (cells.whole and cells.continuous):
        return None
    turned = found.least.value < -found.least.error and found.greatest.value > found.greatest.error
    return True if found.lower > 0 else False if turned else None


def _place(cells: PolynomialCells, extreme: Extreme) -> Points:
    """Where an extreme was found, a trifle inside its cell; one that holds outside all cells, beside their corner."""
    if extreme.cell < 0:
        return cells.position(0, np.full(3, -1.0))
    return cells.position(extreme.cell, np.array(extreme.local) * (1 - 2 * _INSIDE) + _INSIDE)


def _sampled(deformer: SpaceDeformer, proof: Certificate, bounds: tuple[ArrayLike, ArrayLike] | None) -> Certificate:
    """Look for folds on a regular grid."""
    rest = deformer.rest
    if bounds is None and rest.ndim > 1 and rest.shape[-1] == 3 and rest.size:
        corners = rest.reshape(-1, 3)
        bounds = corners.min(axis=0), corners.max(axis=0)
    if bounds is None:
        return proof
    low, high = checked_box(bounds)
    ticks = np.linspace(0, 1, _SAMPLES)
    points = low + (high - low) * np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    ratio = np.linalg.det(deformer.jacobian(points))
    at = int(ratio.argmin())
    least, greatest = float(ratio[at]), float(ratio.max())
    status: Status = "folds" if least <= 0 else "undecided"
    lower, upper = min(proof.lower, least), max(proof.upper, greatest)
    return Certificate(status, lower, upper, least, greatest, points[at], None, "sampled", proof.subdivisions)
