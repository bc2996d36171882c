"""Kernels whose values are 3 × 3 matrices: coordinates that differ, depend on each other, or mirror each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.mesh import as_points
from pliant.shape.kernel_algebra import matrix_diagonal, promoted, unit
from pliant.shape.kernels import Floats, Kernel


@dataclass(frozen=True)
class DiagonalKernel(Kernel):
    """Independent coordinates, each with a scalar kernel of its own.

    Parameters
    ----------
    x, y, z
        The kernel of each coordinate of a displacement.

    Raises
    ------
    InvalidParameter
        A kernel that is not scalar.
    """

    x: Kernel
    y: Kernel
    z: Kernel

    scalar = False

    def __post_init__(self) -> None:
        if not all(each.scalar for each in (self.x, self.y, self.z)):
            raise InvalidParameter("a DiagonalKernel is made of three scalar kernels")

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, 3, m, 3)."""
        return self._laid([each.block(x, y) for each in (self.x, self.y, self.z)])

    def slopes(self, x: Floats, y: Floats) -> Floats:
        return self._laid([each.slopes(x, y) for each in (self.x, self.y, self.z)])

    def diagonal(self, x: Floats) -> Floats:
        return np.stack([each.diagonal(x) for each in (self.x, self.y, self.z)], axis=1)[:, :, None] * np.eye(3)

    @staticmethod
    def _laid(parts: list[Floats]) -> Floats:
        result = np.zeros((len(parts[0]), 3, parts[0].shape[1], 3, *parts[0].shape[2:]))
        for axis, part in enumerate(parts):
            result[:, axis, :, axis] = part
        return result


@dataclass(frozen=True, eq=False)
class DirectedKernel(Kernel):
    """k(x, y) A with a scalar kernel and one symmetric positive semi-definite (3, 3) matrix A.

    Parameters
    ----------
    kernel
        k, a scalar one.
    matrix
        A, (3, 3): which directions there are, and how much of each.

    Raises
    ------
    InvalidParameter
        A is not symmetric, or has a negative eigenvalue.
    """

    kernel: Kernel
    matrix: ArrayLike

    scalar = False

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, np.float64)
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or not np.allclose(matrix, matrix.T):
            raise InvalidParameter("the matrix of a DirectedKernel must be symmetric, (3, 3) and finite")
        lowest = float(np.linalg.eigvalsh(matrix)[0])
        if lowest < -1e-12 * np.abs(matrix).max():
            raise InvalidParameter(f"the matrix of a DirectedKernel has the eigenvalue {lowest:g}: none may be below 0")
        if not self.kernel.scalar:
            raise InvalidParameter("a DirectedKernel needs a scalar kernel")
        object.__setattr__(self, "matrix", matrix)

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, 3, m, 3)."""
        return np.asarray(self.kernel.block(x, y)[:, None, :, None] * np.asarray(self.matrix)[:, None, :])

    def slopes(self, x: Floats, y: Floats) -> Floats:
        return np.asarray(self.kernel.slopes(x, y)[:, None, :, None] * np.asarray(self.matrix)[:, None, :, None])

    def diagonal(self, x: Floats) -> Floats:
        return np.asarray(self.kernel.diagonal(x)[:, None, None] * np.asarray(self.matrix))


@dataclass(frozen=True, eq=False)
class SymmetricKernel(Kernel):
    """Fields that a mirror leaves as they are: u(x) = (v(x) + M v(M x)) / √2 with v from a scalar kernel, M the mirror.

    Then u(M x) = M u(x) exactly, whatever the kernel.

    Parameters
    ----------
    kernel
        A scalar kernel. On the plane itself the variance is twice its own along the plane, and zero across it.
    origin, normal
        (3,) a point on the mirror's plane, and its normal.
    antisymmetric
        u(M x) = −M u(x) instead.
    """

    kernel: Kernel
    origin: ArrayLike = (0.0, 0.0, 0.0)
    normal: ArrayLike = (1.0, 0.0, 0.0)
    antisymmetric: bool = False

    scalar = False

    def __post_init__(self) -> None:
        if not self.kernel.scalar:
            raise InvalidParameter("a SymmetricKernel needs a scalar kernel")
        unit(self.normal)

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, 3, m, 3)."""
        own = (self.kernel.block(x, y) + self.kernel.block(self._mirrored(x), self._mirrored(y))) / 2
        other = (self.kernel.block(x, self._mirrored(y)) + self.kernel.block(self._mirrored(x), y)) / 2
        return promoted(own) + self._sign * other[:, None, :, None] * self._mirror[:, None, :]

    def slopes(self, x: Floats, y: Floats) -> Floats:
        far_x, far_y, turn = self._mirrored(x), self._mirrored(y), self._mirror
        own = (self.kernel.slopes(x, y) + self.kernel.slopes(far_x, far_y) @ turn) / 2
        other = (self.kernel.slopes(x, far_y) + self.kernel.slopes(far_x, y) @ turn) / 2
        return promoted(own) + self._sign * other[:, None, :, None] * turn[:, None, :, None]

    def diagonal(self, x: Floats) -> Floats:
        far = self._mirrored(x)
        own = (self.kernel.diagonal(x) + self.kernel.diagonal(far)) / 2
        pairs = [self.kernel.block(x[i : i + 1], far[i : i + 1])[0, 0] for i in range(len(x))]
        return np.asarray(matrix_diagonal(own) + self._sign * np.asarray(pairs).reshape(-1, 1, 1) * self._mirror)

    @cached_property
    def _mirror(self) -> Floats:
        normal = unit(self.normal)
        return np.asarray(np.eye(3) - 2 * np.outer(normal, normal))

    @property
    def _sign(self) -> float:
        return -1.0 if self.antisymmetric else 1.0

    def _mirrored(self, x: Floats) -> Floats:
        origin = np.asarray(self.origin, np.float64)
        return np.asarray(origin + (x - origin) @ self._mirror)


@dataclass(frozen=True, eq=False)
class SampleCovariance(Kernel):
    """The covariance of fields that were seen, known at the points of a shape.

    Elsewhere that of the nearest such point counts: there is no derivative.

    Parameters
    ----------
    points
        (p, 3) where the fields are known.
    fields
        (s, p, 3) displacements, at least two; their mean is taken off.
    """

    points: ArrayLike
    fields: ArrayLike

    scalar = False

    def __post_init__(self) -> None:
        points, fields = as_points(self.points), np.array(self.fields, np.float64)
        if fields.ndim != 3 or fields.shape[1:] != points.shape or len(fields) < 2 or not np.isfinite(fields).all():
            raise InvalidParameter(
                f"the fields have shape {fields.shape}; at least two of shape {points.shape} are needed, all finite"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "fields", (fields - fields.mean(axis=0)) / np.sqrt(len(fields) - 1))

    def block(self, x: Floats, y: Floats) -> Floats:
        """(n, 3, m, 3)."""
        one, two = self._at(x), self._at(y)
        return np.asarray(np.tensordot(one, two, axes=(0, 0)))

    def slopes(self, x: Floats, y: Floats) -> Floats:
        raise NotDifferentiable("a SampleCovariance is constant around each of its points: it has no derivative")

    def diagonal(self, x: Floats) -> Floats:
        fields = self._at(x)
        return np.asarray(np.einsum("sni,snj->nij", fields, fields))

    def _at(self, x: Floats) -> Floats:
        from scipy.spatial import cKDTree

        nearest = cKDTree(np.asarray(self.points)).query(x)[1] if len(x) else np.empty(0, np.int64)
        return np.asarray(self.fields)[:, nearest]
