"""Shape keys: displacements that are known at a mesh's vertices, each with a weight (blend shapes, morph targets)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Deformer, LinearBinding, Target, checked_controls, checked_out, require_finite
from pliant.errors import InvalidDeformer, InvalidTarget
from pliant.mesh import Points, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import frozen

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ShapeKeys(Deformer):
    """x' = x + the sum over k of w_k d_k. Its controls are the weights, (k,); at rest they are zero.

    Parameters
    ----------
    displacements
        (k, n, 3) of each key, for a mesh of n vertices.
    names
        What the keys are called; none at all numbers them.
    weights
        (k,) how much of each there is; None = zeros.

    Raises
    ------
    InvalidDeformer
        Another shape, or values that are not finite.
    """

    displacements: ArrayLike
    names: Sequence[str] = ()
    weights: ArrayLike | None = None

    def __post_init__(self) -> None:
        moves = as_numbers("displacements", self.displacements, InvalidDeformer)
        if moves.ndim != 3 or moves.shape[2] != 3 or not np.isfinite(moves).all():
            raise InvalidDeformer(f"displacements of shape {moves.shape}: (k, n, 3) finite numbers are needed")
        names = tuple(self.names) or tuple(f"key {i}" for i in range(len(moves)))
        if len(names) != len(moves):
            raise InvalidDeformer(f"{len(moves)} keys have {len(names)} names: each needs one")
        weights = np.zeros(len(moves)) if self.weights is None else checked_controls(self.weights, moves.shape[:1])
        object.__setattr__(self, "displacements", frozen(moves, np.float64))
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "weights", frozen(weights, np.float64))

    @property
    def rest(self) -> Controls:
        """(k,) zeros."""
        return np.zeros(len(self.names))

    @property
    def controls(self) -> Controls:
        """(k,) the weights."""
        return np.asarray(self.weights)

    def moved(self, controls: ArrayLike) -> Self:
        """The same keys with (k,) other weights."""
        return replace(self, weights=checked_controls(controls, self.rest.shape))

    def bind(self, target: Target) -> ShapeKeysBinding:
        """Keep the target's points.

        Raises
        ------
        InvalidTarget
            Another number of points than the keys move.
        """
        points, moves = as_points(target), np.asarray(self.displacements)
        if len(points) != moves.shape[1]:
            raise InvalidTarget(f"the target has {len(points):,} points; the keys move {moves.shape[1]:,}")
        return ShapeKeysBinding(points, moves, self.controls)


class ShapeKeysBinding(LinearBinding):
    """Points with the displacements of keys."""

    def __init__(self, points: Points, moves: Floats, controls: Controls) -> None:
        self._points, self._moves, self._controls = points, moves, controls

    @property
    def rest(self) -> Controls:
        """(k,) zeros."""
        return np.zeros(len(self._moves))

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the points with so much of each key."""
        result = checked_out(out, len(self._points))
        np.add(self._points, self.jvp(None, self._checked(controls)), out=result)
        return require_finite(result, "shape keys")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) the keys, weighted by the change."""
        change = checked_controls(d_controls, self.rest.shape)
        with np.errstate(over="ignore", invalid="ignore"):  # told as an error
            return np.asarray(np.tensordot(change, self._moves, axes=1))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(k,) the transpose of :meth:`jvp`."""
        return np.asarray(np.tensordot(self._moves, checked_controls(d_points, self._points.shape), axes=2))
