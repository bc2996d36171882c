"""A model as a deformer of its own mesh: displacements known at its vertices only."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Controls, Deformer, Target, checked_controls
from pliant.errors import InvalidTarget
from pliant.mesh import as_points
from pliant.numerics.ragged import frozen
from pliant.shape.coefficient_binding import CoefficientBinding
from pliant.shape.domain import Interpolation, carriers

if TYPE_CHECKING:
    from pliant.shape.model import ShapeModel


@dataclass(frozen=True, eq=False)
class ModelDeformer(Deformer):
    """Moves a shape by the displacements of a model's vertices.

    At rest, with all coefficients zero, the reference becomes the mean.

    Parameters
    ----------
    model
        The model.
    coefficients
        (k,) in standard deviations; None = zeros.
    interpolation
        None = the target's vertices are the model's, one by one. ``"nearest"``, ``"surface"``: a target's point
        follows the vertex, or the point of the surface, of the reference that is closest; ``"tetrahedra"``: the
        one that it lies in.
    """

    model: ShapeModel
    coefficients: ArrayLike | None = None
    interpolation: Interpolation | None = None

    def __post_init__(self) -> None:
        given = np.zeros(self.model.count) if self.coefficients is None else self.coefficients
        object.__setattr__(self, "coefficients", frozen(checked_controls(given, (self.model.count,)), np.float64))

    @property
    def rest(self) -> Controls:
        """(k,) zeros."""
        return np.zeros(self.model.count)

    @property
    def controls(self) -> Controls:
        """(k,) the coefficients."""
        return np.asarray(self.coefficients)

    def moved(self, controls: ArrayLike) -> Self:
        """The same model with other coefficients."""
        return replace(self, coefficients=checked_controls(controls, self.rest.shape))

    def bind(self, target: Target) -> CoefficientBinding:
        """Find what each point follows.

        Raises
        ------
        InvalidTarget
            Another number of points than the model's, and no interpolation.
        """
        points, model = as_points(target), self.model
        shift, basis = model.mean - model.reference.points, model.basis
        if self.interpolation is not None:
            corners, weights = carriers(model.reference, points, self.interpolation, model.cells)
            basis = basis.rows(corners, weights)
            shift = np.asarray(np.einsum("mc,mcd->md", weights, shift[corners]))
        elif len(points) != len(shift):
            raise InvalidTarget(
                f"the target has {len(points):,} points, the model {len(shift):,}: give interpolation='surface' "
                "to move other shapes"
            )
        return CoefficientBinding(points, points + shift, basis, self.controls)
