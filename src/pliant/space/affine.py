"""Affine maps: x' = A x + t."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, Self

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
from pliant.mesh import Points, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import frozen
from pliant.space.axes import one_number, unit_axis

Matrix = NDArray[np.float64]
Axis = Literal["x", "y", "z"] | ArrayLike

_IDENTITY = np.eye(3, 4).reshape(-1)


@dataclass(frozen=True, eq=False)
class Affine(SpaceDeformer):
    """An affine map of R^3.

    Its controls are the 12 numbers of A and t, row by row: (a11, a12, a13, t1, a21, ...). At rest it is the
    identity.

    Parameters
    ----------
    matrix
        (4, 4) homogeneous matrix; its last row is (0, 0, 0, 1).
    direction
        What its owner uses it for: to move points, or to fetch each point of an image from where it came.
    carrier
        What a reader kept of its file. Opaque.

    Raises
    ------
    InvalidDeformer
        Another shape, numbers that are not finite, or another last row.
    """

    matrix: Matrix = field(default_factory=lambda: np.eye(4))
    direction: Literal["push-forward", "pull-back"] = "push-forward"
    carrier: Any = None

    def __post_init__(self) -> None:
        matrix = frozen(_array("matrix", self.matrix, (4, 4)), np.float64)
        if not np.isfinite(matrix).all():
            raise InvalidDeformer("the matrix holds numbers that are not finite")
        if not (matrix[3] == (0, 0, 0, 1)).all():
            raise InvalidDeformer(f"the last row of the matrix is {matrix[3].tolist()}; an affine map has 0 0 0 1")
        object.__setattr__(self, "matrix", matrix)

    @classmethod
    def of(cls, linear: ArrayLike, offset: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """The map x' = A x + t from the (3, 3) A and the (3,) t."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = _array("matrix", linear, (3, 3)), _array("offset", offset, (3,))
        return cls(matrix)

    @classmethod
    def translation(cls, offset: ArrayLike) -> Self:
        """Moves every point by (3,).

        Parameters
        ----------
        offset
            (3,) how far: lengths.

        Raises
        ------
        InvalidDeformer
            It is not three finite numbers.
        """
        return cls.of(np.eye(3), offset)

    @classmethod
    def rotation(cls, axis: Axis, angle: float, origin: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """Turns about an axis, ``"x"``, ``"y"``, ``"z"`` or (3,), through a point, by radians, right-handed.

        Parameters
        ----------
        axis
            ``"x"``, ``"y"``, ``"z"``, or (3,) a direction of any length.
        angle
            In radians.
        origin
            (3,) a point of the axis, which stays.

        Raises
        ------
        InvalidDeformer
            The axis is none, or a number is not finite.
        """
        x, y, z = unit_axis(axis)
        angle = one_number("angle", angle)
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        linear = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross  # Rodrigues' formula
        return cls._about(linear, origin)

    @classmethod
    def scaling(cls, factors: ArrayLike, origin: ArrayLike = (0.0, 0.0, 0.0)) -> Self:
        """Scales by one factor, or by one along each axis, away from a point that stays.

        Parameters
        ----------
        factors
            A number, or (3,) of them.
        origin
            (3,) the point that stays.

        Raises
        ------
        InvalidDeformer
            Numbers that are not finite, or another number of them.
        """
        uniform = np.ndim(factors) == 0
        along = np.repeat(_array("factors", factors, ()), 3) if uniform else _array("factors", factors, (3,))
        return cls._about(np.diag(along), origin)

    @classmethod
    def _about(cls, linear: Matrix, origin: ArrayLike) -> Self:
        center = _array("origin", origin, (3,))
        return cls.of(linear, center - linear @ center)

    @property
    def linear(self) -> Matrix:
        """(3, 3) the matrix A."""
        return self.matrix[:3, :3]

    @property
    def offset(self) -> Points:
        """(3,) the translation t."""
        return self.matrix[:3, 3]

    @property
    def rest(self) -> Controls:
        """(12,) the identity."""
        return _IDENTITY.copy()

    @property
    def controls(self) -> Controls:
        """(12,) the first three rows of the matrix."""
        return self.matrix[:3].reshape(-1)

    def moved(self, controls: ArrayLike) -> Self:
        """The map with (12,) other numbers."""
        rows = checked_controls(controls, (12,)).reshape(3, 4)
        return type(self)(np.vstack([rows, [0.0, 0.0, 0.0, 1.0]]), self.direction, self.carrier)

    def bind(self, target: Target) -> AffineBinding:
        """Keep the target's points."""
        return AffineBinding(as_points(target), self.controls)

    def jacobian(self, points: ArrayLike) -> Matrix:
        """(n, 3, 3) the matrix A at each point."""
        return np.repeat(self.linear[None], len(as_points(points)), axis=0)

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from, exactly: the tolerance is not needed.

        Raises
        ------
        InvalidDeformer
            The map is singular: it flattens space.
        """
        return self.inverted()(as_points(points))

    def inverted(self) -> Self:
        """The inverse map.

        Raises
        ------
        InvalidDeformer
            The map is singular: it flattens space.
        """
        if np.linalg.cond(self.linear) > 1 / np.finfo(np.float64).eps:
            raise InvalidDeformer("the affine map flattens space (its matrix is singular): it has no inverse")
        backward = np.linalg.inv(self.linear)
        return self.of(backward, -backward @ self.offset)

    def __matmul__(self, other: Affine) -> Self:
        """``a @ b``: first b, then a."""
        return type(self)(self.matrix @ other.matrix)


class AffineBinding(LinearBinding):
    """Points bound to an affine map: linear in its 12 numbers."""

    def __init__(self, points: Points, controls: Controls) -> None:
        self._points, self._controls = points, controls

    @property
    def rest(self) -> Controls:
        """(12,) the identity."""
        return _IDENTITY.copy()

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """(n, 3) the mapped points."""
        result = checked_out(out, len(self._points))
        rows = self._checked(controls).reshape(3, 4)
        with np.errstate(over="ignore", invalid="ignore"):  # told below, as an error
            result[:] = self._points @ rows[:, :3].T + rows[:, 3]
        return require_finite(result, "affine map")

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) the map is linear in its numbers: this is the map itself, of the change."""
        rows = checked_controls(d_controls, (12,)).reshape(3, 4)
        change: Points = self._points @ rows[:, :3].T + rows[:, 3]
        return change

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """(12,) the transpose of :meth:`jvp`."""
        gradient = checked_controls(d_points, self._points.shape)
        return np.column_stack([gradient.T @ self._points, gradient.sum(axis=0)]).reshape(-1)


def _array(name: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    array = as_numbers(name, values, InvalidDeformer)
    if array.shape != shape:
        raise InvalidDeformer(f"{name} has shape {array.shape}; {shape} is needed")
    return array
