"""A model by hand: sliders choose a shape, landmarks correct it, and the rest follows as the model expects."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Deformer, Target, checked_controls
from pliant.errors import InvalidDeformer, InvalidTarget
from pliant.mesh import Points, as_points
from pliant.numerics.ragged import frozen
from pliant.shape.basis import Floats
from pliant.shape.conditioned_binding import ConditionedBinding
from pliant.shape.correction import Correction
from pliant.shape.domain import checked_vertices
from pliant.shape.kernels import positive
from pliant.shape.posterior import Noise

if TYPE_CHECKING:
    from pliant.shape.model import ShapeModel

EXACT = 1e-3  # of the shape's size: the noise of landmarks where none is given


@dataclass(frozen=True, eq=False)
class ConditionedModel(Deformer):
    """A shape of a model, by coefficients, and by landmarks that are seen somewhere.

    Coefficients z say which shape; landmarks correct it: z + K (p − x(z)), where p are their positions, x(z) where the
    shape of z has them, and K the gain of the posterior mean (Lüthi et al. 2018, eq. 25). With z = 0 it is the
    posterior mean; with normal z, a sample of the posterior whose landmarks are met but for their noise. A landmark
    put where it is changes nothing. Controls are the coefficients and then the positions, flat; linear in both.

    Parameters
    ----------
    model
        The model, whose vertices the target's are, one by one.
    coefficients
        (k,) z, in standard deviations; None = zeros.
    vertices
        (m,) which vertices are landmarks.
    positions
        (m, 3) where they are seen; None = where the mean has them.
    noise
        How exactly they are seen, a standard deviation: a length; None = a thousandth of the diagonal.

    Raises
    ------
    InvalidDeformer
        Another number of positions than vertices, or values that are not finite.
    InvalidParameter
        A vertex that the model has not, or noise that is not positive.
    """

    model: ShapeModel
    coefficients: ArrayLike | None = None
    vertices: ArrayLike = ()
    positions: ArrayLike | None = None
    noise: float | None = None

    def __post_init__(self) -> None:
        model = self.model
        chosen = checked_vertices(self.vertices, len(model.mean))
        given = np.zeros(model.count) if self.coefficients is None else self.coefficients
        seen = np.asarray(model.mean[chosen] if self.positions is None else self.positions, np.float64)
        if seen.shape != (len(chosen), 3) and (len(chosen) or seen.size):
            raise InvalidDeformer(f"{len(chosen)} landmarks have positions of shape {seen.shape}: ({len(chosen)}, 3)")
        if not np.isfinite(seen).all():
            raise InvalidDeformer("a landmark's position is not finite")
        size = model.reference.diagonal or 1.0
        noise = positive("the noise of landmarks", EXACT * size if self.noise is None else self.noise)
        object.__setattr__(self, "coefficients", frozen(checked_controls(given, (model.count,)), np.float64))
        object.__setattr__(self, "vertices", frozen(chosen, np.int64))
        object.__setattr__(self, "positions", frozen(seen.reshape(-1, 3), np.float64))
        object.__setattr__(self, "noise", noise)

    @property
    def rest(self) -> Controls:
        """(k + 3 m,) zeros, and the landmarks where the mean has them."""
        return np.concatenate([np.zeros(self.model.count), self.model.mean[self._chosen].reshape(-1)])

    @property
    def controls(self) -> Controls:
        """(k + 3 m,) the coefficients, and the positions of the landmarks."""
        return np.concatenate([np.asarray(self.coefficients), np.asarray(self.positions).reshape(-1)])

    def moved(self, controls: ArrayLike) -> Self:
        """The same model and landmarks, with other coefficients and positions."""
        count = self.model.count
        flat = checked_controls(controls, (count + 3 * len(self._chosen),))
        other = replace(self, coefficients=flat[:count], positions=flat[count:].reshape(-1, 3))
        other.__dict__.update({name: self.__dict__[name] for name in ("_correction",) if name in self.__dict__})
        return other

    @property
    def corrected(self) -> Floats:
        """(k,) the model's coefficients of the shape: z, corrected by the landmarks."""
        given = np.asarray(self.coefficients)
        if self._correction is None:
            return given.copy()
        return self._correction(given, np.asarray(self.positions) - self.model.mean[self._chosen])

    @property
    def points(self) -> Points:
        """(n, 3) the shape."""
        return self.model.instance(self.corrected)

    def posterior(self) -> ShapeModel:
        """The model that knows the landmarks; its mean is the shape of zero coefficients."""
        if not len(self._chosen):
            return self.model
        assert self.noise is not None
        assert self.positions is not None
        return self.model.posterior(self._chosen, self.positions, noise=self.noise)

    def with_landmark(self, vertex: int) -> Self:
        """With one more landmark, where the shape has it now: nothing moves.

        Parameters
        ----------
        vertex
            Which vertex of the model.

        Raises
        ------
        InvalidParameter
            The model has no such vertex.
        """
        chosen = checked_vertices([vertex], len(self.model.mean))
        place = self.model.basis.rows(chosen).apply(self.corrected) + self.model.mean[chosen]
        seen = np.vstack([np.asarray(self.positions), place])
        return replace(self, vertices=np.append(self._chosen, chosen), positions=seen)

    def without_landmarks(self, places: ArrayLike) -> Self:
        """Without some landmarks.

        Parameters
        ----------
        places
            (j,) which, by their places in the list of them.

        Raises
        ------
        InvalidParameter
            There are not so many.
        """
        left_out = checked_vertices(places, len(self._chosen))
        kept = np.delete(np.arange(len(self._chosen)), left_out)
        return replace(self, vertices=self._chosen[kept], positions=np.asarray(self.positions)[kept])

    def bind(self, target: Target) -> ConditionedBinding:
        """Prepare the shape of a mesh with the model's vertices.

        Raises
        ------
        InvalidTarget
            Another number of points than the model's.
        """
        points, model = as_points(target), self.model
        if len(points) != len(model.mean):
            raise InvalidTarget(
                f"the target has {len(points):,} points, the model {len(model.mean):,}: a model moves its own mesh; "
                "to move others, use model.deformer(interpolation='surface')"
            )
        base = points + (model.mean - model.reference.points)
        return ConditionedBinding(points, base, model.basis, self._correction, model.mean[self._chosen], self.controls)

    @property
    def _chosen(self) -> NDArray[np.int64]:
        return np.asarray(self.vertices, np.int64)

    @cached_property
    def _correction(self) -> Correction | None:
        if not len(self._chosen):
            return None
        assert self.noise is not None
        return Correction(self.model.basis.rows(self._chosen), Noise.of(self.noise, len(self._chosen)))
