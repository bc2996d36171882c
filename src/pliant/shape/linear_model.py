"""A mean shape and fields with normal coefficients: drawing shapes, and finding the coefficients of given ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from pliant.deformer import checked_controls
from pliant.errors import InvalidMesh
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.ragged import frozen
from pliant.shape.basis import Basis, Floats
from pliant.shape.domain import checked_vertices
from pliant.shape.low_rank import Convention, LowRank

RIDGE = 1e-14  # of the largest eigenvalue: coefficients of fields that a shape does not show are zero


@dataclass(frozen=True, eq=False, repr=False)
class LinearModel:
    """What all models have; the parameters are those of :class:`~pliant.shape.model.ShapeModel`."""

    reference: PolygonMesh
    mean: Points
    basis: Basis
    process: LowRank | None = None
    cells: NDArray[np.int32] | None = None
    convention: Convention = "discrete"
    noise_variance: float = 0.0
    carrier: Any = None

    def __post_init__(self) -> None:
        mean, count = as_points(self.mean), len(self.reference.points)
        if len(mean) != count or self.basis.size != count:
            raise InvalidMesh(
                f"the reference has {count} points, the mean {len(mean)} and the fields {self.basis.size}: all must "
                "have the same"
            )
        object.__setattr__(self, "mean", frozen(mean, np.float64))
        self.basis.freeze()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self.mean):,} points, rank {self.rank}, {self.count} coefficients)"

    @property
    def rank(self) -> int:
        """How many fields there are; a scalar one counts once."""
        return self.basis.rank

    @property
    def count(self) -> int:
        """k, how many coefficients a shape has."""
        return self.basis.count

    @property
    def variances(self) -> Floats:
        """(rank,) eigenvalues, descending: squared lengths, by :attr:`convention`."""
        return self.basis.deviations**2

    def instance(self, coefficients: ArrayLike) -> Points:
        """(..., n, 3) the shapes of (..., k) coefficients, in standard deviations.

        Raises
        ------
        InvalidControls
            Another number of coefficients, or some that are not finite.
        """
        given = np.asarray(coefficients, np.float64)
        checked = checked_controls(given, (*given.shape[:-1], self.count))
        return np.asarray(self.basis.apply(checked, base=self.mean), np.float64)

    def sample(self, count: int, *, seed: int | None = None, dtype: DTypeLike = np.float64) -> NDArray[np.floating]:
        """(count, n, 3) random shapes; a seed makes them repeatable, float32 makes them in half the time."""
        normal = np.random.default_rng(seed).standard_normal((count, self.count))
        return self.basis.apply(normal, dtype, self.mean)

    def mesh(self, coefficients: ArrayLike | None = None) -> PolygonMesh:
        """The mesh of (k,) coefficients; None = of the mean."""
        return self.reference.with_points(self.mean if coefficients is None else self.instance(coefficients))

    def coefficients(self, shape: PolygonMesh | ArrayLike) -> Floats:
        """(k,) the coefficients whose shape comes nearest to one in correspondence, in the least squares sense.

        Raises
        ------
        InvalidMesh
            Another number of points than the model's.
        """
        points = self._corresponding(shape)
        values, vectors = self._spectrum
        right = self.basis.transpose(points - self.mean).reshape(len(values), -1)
        scaled = (vectors.T @ right) * (values / (values**2 + (RIDGE * values[-1]) ** 2))[:, None]
        return np.asarray(vectors @ scaled).reshape(-1)

    def project(self, shape: PolygonMesh | ArrayLike) -> Points:
        """(n, 3) the shape of the model that comes nearest to one in correspondence."""
        return self.instance(self.coefficients(shape))

    def logpdf(self, shape: PolygonMesh | ArrayLike) -> float:
        """The logarithm of the density of a shape's coefficients: of what the model sees of it."""
        coefficients = self.coefficients(shape)
        return -0.5 * float(coefficients @ coefficients + self.count * np.log(2 * np.pi))

    def covariance(self, points: ArrayLike, others: ArrayLike | None = None) -> Floats:
        """(m, 3, j, 3) the covariance between vertices (m,) and (j,); None = between the first themselves."""
        one = self.basis.rows(self._indices(points)).columns()
        two = one if others is None else self.basis.rows(self._indices(others)).columns()
        return np.asarray(np.tensordot(one, two, axes=(2, 2)))

    @cached_property
    def uncertainty(self) -> Floats:
        """(n,) how far each vertex strays, the root of its mean square distance from the mean: a length."""
        return np.asarray(np.sqrt(np.trace(self.basis.covariances(), axis1=1, axis2=2)))

    def _corresponding(self, shape: PolygonMesh | ArrayLike) -> Points:
        points = as_points(shape)
        if len(points) != len(self.mean):
            raise InvalidMesh(
                f"the shape has {len(points):,} points, the model {len(self.mean):,}: they do not correspond; fit() "
                "finds the model's shape nearest to any mesh"
            )
        return points

    def _indices(self, vertices: ArrayLike) -> NDArray[np.int64]:
        return checked_vertices(vertices, len(self.mean))

    @cached_property
    def _spectrum(self) -> tuple[Floats, Floats]:
        """Eigenvalues, ascending, and eigenvectors of the fields' inner products."""
        values, vectors = np.linalg.eigh(self.basis.gram(np.ones(self.basis.size)))
        return np.maximum(values, 0.0) + 1e-300, vectors
