"""How far a deformation may go before it folds."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidDeformer, InvalidParameter, NotConverged, PliantWarning
from pliant.field.certifying import certify, determinants_of, polynomial_cells
from pliant.numerics.lattices.crossings import CUBIC_FROM_SAMPLES, positive_until, restriction
from pliant.numerics.lattices.determinants import UNIT, Determinants, halve, halving_error
from pliant.space.placed import Placed

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Map = TypeVar("Map", bound=SpaceDeformer)

_AT_ONCE = 64  # cells and boxes looked at together
_CLOSE = 1e-3  # how far below the first crossing found the limit may stay
_OVERLAP = 1e-9  # by how much spans of t overlap, so that rounding leaves no gap between them


def limit_to_fold_free(deformer: Map, margin: float = 1e-3, *, budget: int = 20_000) -> Map:
    """The deformation as far as it goes without folding.

    Displacements are multiplied by the largest t in (0, 1] such that det J >= margin everywhere for *every* step up
    to t, to within a thousandth below. Without a margin there would be no largest: det J > 0 is an open condition.

    det J is a cubic polynomial of t, so that in each cell it is a polynomial of four variables; its Bernstein
    coefficients, widened by all roundings, give a cubic of t that lies below det J in the whole cell. How far that
    one stays above the margin is a proved bound of t; cells are halved until it meets what is found at their corners.

    Parameters
    ----------
    deformer
        A lattice of B-splines or Bézier polynomials, or one that was placed. An affine part stays as it is.
    margin
        The least det J to be kept.
    budget
        How many boxes may be halved.

    Returns
    -------
    SpaceDeformer
        Of the same kind, certified fold-free; the deformer itself if t = 1.

    Raises
    ------
    InvalidParameter
        A margin that is not positive, or that even the deformer at rest does not keep.
    InvalidDeformer
        A deformer whose displacements are no polynomials.
    NotConverged
        The limit found could not be certified within the budget: raise it, or the margin.

    Warns
    -----
    PliantWarning
        The budget ended before the limit was found to a thousandth: t is safe, but might be larger.
    """
    if isinstance(deformer, Placed):
        limited = limit_to_fold_free(deformer.deformer, margin, budget=budget)
        return deformer if limited is deformer.deformer else replace(deformer, deformer=limited)
    cells = polynomial_cells(deformer)
    if cells is None:
        name = type(deformer).__name__
        raise InvalidDeformer(f"a {name} is no lattice of polynomials: only those can be limited, cell by cell")
    polynomials = determinants_of(cells)
    if not 0 < margin < polynomials.at_rest:
        least = float(polynomials.at_rest)
        raise InvalidParameter(f"the margin must lie between 0 and {least:g}, det J at rest; it is {margin}")
    step = _largest_step(polynomials, margin, budget)
    if step == 1:
        return deformer
    whole: Any = deformer
    for _ in range(8):  # the displacements are rounded again when they are multiplied
        limited = replace(whole, displacements=step * whole.displacements)
        if certify(limited, budget=budget).status == "fold-free":
            return limited  # type: ignore[no-any-return]
        step *= 1 - _CLOSE
    raise NotConverged(f"a step of {step:.4g} keeps det J >= {margin:g}, but its proof needs more than {budget} boxes")


@dataclass(frozen=True, eq=False)
class _Boxes:
    """Parts of cells, each for a span of steps.

    Parameters
    ----------
    coefficients
        (k, 4, ...) Bernstein coefficients of det J - margin in t and space.
    error
        (k,) by how much rounding may have changed them.
    start, stop
        (k,) the spans of t; up to its start a box is known to be safe.
    """

    coefficients: Floats
    error: Floats
    start: Floats
    stop: Floats

    @property
    def safe(self) -> Floats:
        """(k,) how far t may go, proved."""
        lowest = self.coefficients.min(axis=(2, 3, 4)) - self.error[:, None]
        return self.start + (self.stop - self.start) * positive_until(lowest)

    @property
    def crossing(self) -> float:
        """The least t at which det J falls to the margin at a corner of a box; infinite if it does nowhere."""
        corners = self.coefficients[:, :, [0, -1]][:, :, :, [0, -1]][:, :, :, :, [0, -1]]
        values = np.moveaxis(corners, 1, -1).reshape(-1, 8, 4)
        falls = (values <= 0).any(axis=2)
        part = positive_until(values[falls])
        box = np.nonzero(falls)[0]
        found = self.start[box] + (self.stop - self.start)[box] * part
        return float(found[part < 1].min(initial=np.inf))

    def chosen(self, which: NDArray[np.bool_] | Integers) -> _Boxes:
        return _Boxes(*(values[which] for values in vars(self).values()))

    def within(self, start: Floats, stop: float) -> _Boxes:
        """The same boxes for shorter spans of t, where coefficients of one box differ less."""
        width = self.stop - self.start
        begin = np.maximum((start - self.start) / width - _OVERLAP, 0.0)
        end = np.clip((stop - self.start) / width, begin + _OVERLAP, 1.0)
        coefficients = np.einsum("kst,kt...->ks...", restriction(begin, end), self.coefficients)
        error = self.error + 32 * UNIT * np.abs(self.coefficients).max(axis=(1, 2, 3, 4))
        return _Boxes(coefficients, error, start, self.start + end * width)

    def halved(self) -> _Boxes:
        """Two boxes for one, cut across the axis of space along which the coefficients vary most."""
        steps = [np.abs(np.diff(self.coefficients, axis=2 + axis)) for axis in range(3)]
        spread = np.stack([s.max(axis=(1, 2, 3, 4), initial=0.0) * s.shape[2 + a] for a, s in enumerate(steps)])
        cut = spread.argmax(axis=0)
        return _joined([half for axis in range(3) for half in self.chosen(cut == axis)._cut(axis)])

    def _cut(self, axis: int) -> list[_Boxes]:
        error = self.error + halving_error(self.coefficients, self.coefficients.shape[2 + axis] - 1)
        return [replace(self, coefficients=half, error=error) for half in halve(self.coefficients, 2 + axis)]


def _joined(parts: list[_Boxes]) -> _Boxes:
    return _Boxes(*(np.concatenate(values) for values in zip(*(vars(part).values() for part in parts), strict=True)))


def _largest_step(polynomials: Determinants, margin: float, budget: int) -> float:
    """The largest proved t: no smaller than a thousandth below the first crossing, if the budget allows."""
    search = _Search()
    _look_at_cells(search, polynomials, margin)
    halved = 0
    while len(search.safe) and halved < budget:
        order = np.argsort(search.safe)
        worst, rest = order[:_AT_ONCE], order[_AT_ONCE:]
        children = search.open.chosen(worst).within(search.safe[worst], search.first).halved()
        search.open, search.safe = search.open.chosen(rest), search.safe[rest]
        search.take(children)
        halved += len(worst)
    proved = min(search.proved, float(search.safe.min(initial=1.0)))
    if len(search.safe):
        warnings.warn(
            f"after {halved:,} boxes the limit lies between {proved:.4g} and {search.first:.4g} of the displacement; "
            "the lower one is taken (raise budget= to come closer)",
            PliantWarning,
            stacklevel=3,
        )
    return proved if proved == 1 else proved * (1 - 1000 * _OVERLAP)


class _Search:
    """The first crossing found, what is proved of closed boxes, and the boxes that are open."""

    def __init__(self) -> None:
        self.first, self.proved = 1.0, 1.0
        self.open: _Boxes
        self.safe = np.empty(0)

    def take(self, boxes: _Boxes) -> None:
        """Look at new boxes, and close those that are safe nearly as far as the first crossing."""
        self.first = min(self.first, boxes.crossing)
        safe = boxes.safe
        if len(self.safe):
            boxes, safe = _joined([self.open, boxes]), np.concatenate([self.safe, safe])
        is_open = safe < self.first * (1 - _CLOSE)
        self.proved = min(self.proved, float(safe[~is_open].min(initial=1.0)))
        self.open, self.safe = boxes.chosen(is_open), safe[is_open]


def _look_at_cells(search: _Search, polynomials: Determinants, margin: float) -> None:
    """Whole cells, those that move most first, as far as rough bounds leave a doubt about them."""
    low, _ = polynomials.ranges(np.arange(np.prod(polynomials.cells.counts)), path=1.0)
    doubtful = np.flatnonzero(low <= margin)
    doubtful = doubtful[np.argsort(low[doubtful])]
    for start in range(0, len(doubtful), _AT_ONCE):
        part = doubtful[start : start + _AT_ONCE]
        part = part[polynomials.ranges(part, path=search.first)[0] <= margin]
        if len(part):
            search.take(_in_time(polynomials, part, margin, search.first))


def _in_time(polynomials: Determinants, cells: Integers, margin: float, stop: float) -> _Boxes:
    """Whole cells: det J - margin at four steps gives the cubic of t."""
    samples = [polynomials.coefficients(cells, step) for step in (0.0, stop / 3, stop * 2 / 3, stop)]
    values = np.stack([coefficients for coefficients, _ in samples], axis=1)
    cubic = np.einsum("st,kt...->ks...", CUBIC_FROM_SAMPLES, values) - margin
    growth = np.abs(CUBIC_FROM_SAMPLES).sum(axis=1).max() * 1.01
    error = growth * np.max([error for _, error in samples], axis=0) + 16 * UNIT * (margin + np.abs(cubic).max())
    return _Boxes(cubic, error, np.zeros(len(cells)), np.full(len(cells), stop))
