"""The range of det J over the cells of a polynomial map: proved bounds by branch and bound.

The Bernstein coefficients of a cell bound det J from both sides, and those at its corners are values. Boxes whose
bounds are not yet close to the least or greatest value found are halved, the most promising first: bounds converge
quadratically.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.lattices.determinants import Determinants, halve, halving_error

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_AT_ONCE = 256  # boxes looked at together
_ROUGHLY = 4096  # cells whose rough bounds are found together


@dataclass
class Extreme:
    """The lowest value found, and where; of -det J for the greatest."""

    value: float
    error: float = 0.0
    cell: int = -1
    local: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Range:
    """Proved bounds, the extremes found, and how many boxes were halved."""

    lower: float
    upper: float
    least: Extreme
    greatest: Extreme
    halved: int


@dataclass(frozen=True, eq=False)
class Boxes:
    """Parts of cells, with det J in Bernstein form on each.

    Parameters
    ----------
    coefficients
        (k, ...).
    error
        (k,) by how much rounding may have changed a coefficient.
    cell, origin, size
        (k,) the cell, (k, 3) the lowest corner in it, (k, 3) the lengths.
    """

    coefficients: Floats
    error: Floats
    cell: Integers
    origin: Floats
    size: Floats

    @classmethod
    def of(cls, polynomials: Determinants, cells: Integers) -> Boxes:
        """Whole cells."""
        coefficients, error = polynomials.coefficients(cells)
        return cls(coefficients, error, cells, np.zeros((len(cells), 3)), np.ones((len(cells), 3)))

    @property
    def low(self) -> Floats:
        """(k,) lower bounds of det J."""
        return np.asarray(self.coefficients.min(axis=(1, 2, 3)) - self.error)

    @property
    def high(self) -> Floats:
        """(k,) upper bounds of det J."""
        return np.asarray(self.coefficients.max(axis=(1, 2, 3)) + self.error)

    def chosen(self, which: NDArray[np.bool_] | Integers) -> Boxes:
        """Some of the boxes."""
        return Boxes(
            self.coefficients[which], self.error[which], self.cell[which], self.origin[which], self.size[which]
        )

    def joined(self, other: Boxes) -> Boxes:
        """These boxes and others."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Boxes(*(np.concatenate(pair) for pair in pairs))

    def halved(self) -> Boxes:
        """Two boxes for one, cut across the axis along which the coefficients vary most."""
        steps = [np.abs(np.diff(self.coefficients, axis=1 + axis)) for axis in range(3)]
        spread = np.stack([step.max(axis=(1, 2, 3), initial=0.0) * step.shape[1 + a] for a, step in enumerate(steps)])
        cut = spread.argmax(axis=0)
        return _concatenated([self.chosen(cut == axis)._cut(axis) for axis in range(3) if (cut == axis).any()])

    def _cut(self, axis: int) -> Boxes:
        lower, upper = halve(self.coefficients, 1 + axis)
        error = self.error + halving_error(self.coefficients, self.coefficients.shape[1 + axis] - 1)
        size, beyond = self.size.copy(), self.origin.copy()
        size[:, axis] /= 2
        beyond[:, axis] += size[:, axis]
        return Boxes(lower, error, self.cell, self.origin, size).joined(Boxes(upper, error, self.cell, beyond, size))

    def lowest_corner(self, sign: float) -> Extreme:
        """The least of sign * det J at the boxes' corners."""
        corners = sign * self.coefficients[:, [0, -1]][:, :, [0, -1]][:, :, :, [0, -1]].reshape(len(self.cell), 8)
        box, corner = divmod(int(corners.argmin()), 8)
        at = self.origin[box] + self.size[box] * [corner >> 2, corner >> 1 & 1, corner & 1]
        x, y, z = at.tolist()
        return Extreme(float(corners[box, corner]), float(self.error[box]), int(self.cell[box]), (x, y, z))


def determinant_range(
    polynomials: Determinants, budget: int, tolerance: float, progress: Callable[[float], object] | None = None
) -> Range:
    """Bounds of det J over all cells, and over what lies beyond them.

    Parameters
    ----------
    polynomials
        det J in each cell.
    budget
        How many boxes may be halved, after one look at each cell.
    tolerance
        How close the bounds should come to the values found, relative to these.
    progress
        Is told what part of the budget is spent, from 0 to 1.
    """
    return _Search(polynomials, tolerance).run(budget, progress)


class _Search:
    """Branch and bound: what was found, what is open, and the bounds of what is closed."""

    def __init__(self, polynomials: Determinants, tolerance: float) -> None:
        self._polynomials, self._tolerance = polynomials, tolerance
        beyond = polynomials.cells.whole
        rest = float(polynomials.at_rest)
        self._least, self._greatest = (Extreme(sign * rest if beyond else np.inf) for sign in (1.0, -1.0))
        below, above = np.nextafter(rest, -np.inf), np.nextafter(rest, np.inf)
        self._lower, self._upper = (float(below), float(above)) if beyond else (np.inf, -np.inf)
        self._open: Boxes | None = None

    def run(self, budget: int, progress: Callable[[float], object] | None) -> Range:
        self._look_at_cells()
        halved = 0
        while self._open is not None and len(self._open.cell) and halved < budget:
            worst = self._worst(self._open.low, self._open.high, min(_AT_ONCE, budget - halved))
            rest = np.ones(len(self._open.cell), bool)
            rest[worst] = False
            children = self._open.chosen(worst).halved()
            halved += len(worst)
            self._open = self._open.chosen(rest)
            self._take(children)
            if progress is not None:
                progress(halved / budget)
        lower, upper = self._lower, self._upper
        if self._open is not None and len(self._open.cell):
            lower = min(lower, float(self._open.low.min()))
            upper = max(upper, float(self._open.high.max()))
        greatest = self._greatest
        greatest = Extreme(-greatest.value, greatest.error, greatest.cell, greatest.local)
        return Range(lower, upper, self._least, greatest, halved)

    def _look_at_cells(self) -> None:
        """Whole cells, as long as their rough bounds leave anything open."""
        count = int(np.prod(self._polynomials.cells.counts))
        low, high = np.empty(count), np.empty(count)
        for start in range(0, count, _ROUGHLY):
            part = np.arange(start, min(start + _ROUGHLY, count))
            low[part], high[part] = self._polynomials.ranges(part)
        waiting = np.arange(count)
        while len(waiting):
            open_still = self._is_open(low[waiting], high[waiting])
            self._close(low[waiting[~open_still]], high[waiting[~open_still]])
            waiting = waiting[open_still]
            worst = self._worst(low[waiting], high[waiting], _AT_ONCE)
            if len(worst):
                self._take(Boxes.of(self._polynomials, waiting[worst]))
                waiting = np.delete(waiting, worst)

    def _take(self, boxes: Boxes) -> None:
        """Look at boxes: their corners' values, and whether they are open or closed."""
        for sign, best in ((1.0, "_least"), (-1.0, "_greatest")):
            found = boxes.lowest_corner(sign)
            if found.value < getattr(self, best).value:
                setattr(self, best, found)
        boxes = boxes if self._open is None else self._open.joined(boxes)
        low, high = boxes.low, boxes.high
        is_open = self._is_open(low, high)
        self._close(low[~is_open], high[~is_open])
        self._open = boxes.chosen(is_open)

    def _close(self, low: Floats, high: Floats) -> None:
        self._lower = min(self._lower, float(low.min(initial=np.inf)))
        self._upper = max(self._upper, float(high.max(initial=-np.inf)))

    def _is_open(self, low: Floats, high: Floats) -> NDArray[np.bool_]:
        """Which boxes may hold values beyond those that were found, by more than the tolerance."""
        least, greatest = self._least.value, -self._greatest.value
        spread = 0.01 * (greatest - least)
        below = least * (1 - self._tolerance) if least > 0 else least - self._tolerance * max(-least, spread)
        above = greatest + self._tolerance * max(abs(greatest), spread)
        return np.asarray((low < below) | (high > above))

    def _worst(self, low: Floats, high: Floats, count: int) -> Integers:
        """The most promising boxes: the lowest, and the highest."""
        if len(low) <= count:
            return np.arange(len(low))
        half = -(-count // 2)
        lowest = np.argpartition(low, half)[:half]
        return np.unique(np.concatenate([lowest, np.argpartition(-high, half)[:half]]))[:count]


def _concatenated(parts: list[Boxes]) -> Boxes:
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.joined(part)
    return whole
