"""Scale: each axis of a frame by a factor of its own (Barr 1984, section 3.1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import (
    Controls,
    LinearBinding,
    SpaceDeformer,
    Target,
    checked_controls,
    checked_out,
    require_finite,
)
from pliant.errors import InvalidDeformer
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.ragged import frozen
from pliant.space.axes import extent_along, three_numbers
from pliant.space.box import checked_axes

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Scale(SpaceDeformer):
    """Scale space by a factor along each of three axes, away from a point that stays.

    Normals n become (nx / x, ny / y, nz / z) times det J = x y z (Barr 1984, section 3.1).

    Parameters
    ----------
    x, y, z
        The factors; negative ones mirror. Its controls.
    origin
        (3,) the point that stays.
    axes
        (3, 3) orthonormal columns along which is scaled; None = the world's.

    Raises
    ------
    InvalidDeformer
        Numbers that are not finite, axes that are not orthonormal.
    """

    x: float = 1.0
    y: float = 1.0
    z: float = 1.0
    origin: ArrayLike = (0.0, 0.0, 0.0)
    axes: ArrayLike | None = None

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    neutral: ClassVar[Mapping[str, float]] = MappingProxyType({"x": 1.0, "y": 1.0, "z": 1.0})

    def __post_init__(self) -> None:
        for name, value in zip(self.parameters, three_numbers("scale", [self.x, self.y, self.z]).tolist(), strict=True):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "origin", frozen(three_numbers("origin", self.origin), np.float64))
        object.__setattr__(self, "axes", frozen(checked_axes(self.axes), np.float64))

    @classmethod
    def around(cls, target: PolygonMesh | ArrayLike, **fields: Any) -> Self:
        """Laid around a shape: the middle of its bounding box stays, if no origin is among ``fields``.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        fields
            Those of the deformer.
        """
        low, high = extent_along(target, np.eye(3))
        return cls(**{"origin": (low + high) / 2, **fields})

    @property
    def rest(self) -> Controls:
        """(3,) ones."""
        return np.ones(3)

    @property
    def controls(self) -> Controls:
        """(3,) the factors."""
        return np.array([self.x, self.y, self.z])

    def moved(self, controls: ArrayLike) -> Self:
        """The deformer with (3,) other factors."""
        x, y, z = checked_controls(controls, (3,)).tolist()
        return replace(self, x=x, y=y, z=z)

    def bind(self, target: Target) -> ScaleBinding:
        """Keep the target's points."""
        return ScaleBinding(as_points(target), np.asarray(self.origin), np.asarray(self.axes), self.controls)

    def jacobian(self, points: ArrayLike) -> Floats:
        axes = np.asarray(self.axes)
        return np.repeat(((axes * self.controls) @ axes.T)[None], len(as_points(points)), axis=0)

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, exactly: the tolerance is not needed.

        Raises
        ------
        InvalidDeformer
            A factor is zero: space is flattened.
        """
        if not self.controls.all():
            raise InvalidDeformer("a scale by zero flattens space: it has no inverse")
        return self.moved(1 / self.controls)(as_points(points))


class ScaleBinding(LinearBinding):
    """Points bound to a scale: linear in its three factors."""

    def __init__(self, points: Points, origin: Floats, axes: Floats, controls: Controls) -> None:
        self._points, self._origin, self._axes, self._controls = points, origin, axes, controls

    @property
    def rest(self) -> Controls:
        """(3,) ones."""
        return np.ones(3)

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the scaled points."""
        result = checked_out(out, len(self._points))
        with np.errstate(over="ignore", invalid="ignore"):  # told below, as an error
            np.add(self._points, self.jvp(None, self._checked(controls) - 1), out=result)
        return require_finite(result, "scale")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) how the points move when the factors change."""
        change = checked_controls(d_controls, (3,))
        return np.asarray((self._points - self._origin) @ ((self._axes * change) @ self._axes.T))

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(3,) the transpose of :meth:`jvp`."""
        gradient = checked_controls(d_points, self._points.shape)
        moments = gradient.T @ (self._points - self._origin)
        return np.asarray(np.einsum("ik,ij,jk->k", self._axes, moments, self._axes))
