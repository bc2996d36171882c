"""Gaussian processes of displacements, without any mesh: what is known of a map of space from what was seen of it.

Means and samples are maps of space. A sample of the posterior is a sample of the prior, corrected by what it misses
of the observations (Matheron's rule): all is a sum of kernels around few centres.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import SpaceDeformer, Target
from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.shape.basis import Floats, everywhere
from pliant.shape.kernels import Kernel
from pliant.shape.low_rank import LowRank
from pliant.shape.pivoted_cholesky import pivoted_cholesky
from pliant.shape.posterior import Noise, warn_of_contradictions
from pliant.shape.random_field import RandomField

_GRID = 13  # points an edge of the box in which a sample is accurate
_MOST = 3000  # points of a domain that a sample looks at
_ROUNDING = 1e-10  # of the variance: keeps solvable what is observed twice


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """Random displacement fields with a covariance, and what was observed of them.

    Parameters
    ----------
    kernel
        The covariance; ``scale`` is an amplitude, a length.
    prior
        A map of space around which the fields lie; None = the identity.
    places, values
        (m, 3) where displacements were observed, and (m, 3) the displacements.
    noise
        Of the observations.
    """

    kernel: Kernel
    prior: SpaceDeformer | None = None
    places: Points | None = None
    values: Points | None = None
    noise: Noise | None = None

    def posterior(self, points: ArrayLike, values: ArrayLike, *, noise: ArrayLike) -> Self:
        """The process that knows displacements (m, 3) at points (m, 3), besides what it knew.

        Parameters
        ----------
        points, values
            Where, and how far things moved there.
        noise
            A standard deviation (a length), (m,) of them, or (m, 3, 3) covariance matrices.

        Raises
        ------
        InvalidParameter
            Other numbers of values than points, or noise that is not positive.

        Warns
        -----
        PliantWarning
            Observations of one place contradict each other.
        """
        places, seen = as_points(points), as_points(values)
        if len(places) != len(seen):
            raise InvalidParameter(f"{len(places)} points have {len(seen)} displacements: each needs one")
        error = Noise.of(noise, len(places))
        if self.places is not None and self.values is not None and self.noise is not None:
            places, seen = np.vstack([self.places, places]), np.vstack([self.values, seen])
            error = self.noise.joined(error)
        warn_of_contradictions(places, seen, error)
        return replace(self, places=places, values=seen, noise=error)

    def mean(self, points: Target) -> Points:
        """(n, 3) the mean displacement at the points of a mesh, or at (n, 3) points.

        Parameters
        ----------
        points
            Where: a mesh, or (n, 3).
        """
        places = as_points(points)
        return np.asarray(self.deformer()(places) - places)

    def covariance(self, points: Target) -> Floats:
        """(n, 3, n, 3) the covariance of displacements at points, after what was observed.

        Parameters
        ----------
        points
            Where: a mesh, or (n, 3); a hundred points take 720 kB.
        """
        places = as_points(points)
        count = 3 * len(places)
        own = self._matrix(places, places)
        if self.places is not None:
            across = self._matrix(places, self.places)
            own = own - across @ np.linalg.solve(self._system, across.T)
        return np.asarray(own.reshape(count // 3, 3, count // 3, 3))

    def deformer(self) -> RandomField:
        """The mean as a map of space."""
        rank = len(self._centers) * (1 if self.kernel.scalar else 3)
        empty = LowRank(self.kernel, self._centers, np.zeros((rank, 0)), np.zeros(0), "discrete", 1.0, self._drift)
        return RandomField(empty, prior=self.prior)

    def sample(
        self,
        *,
        seed: int | None = None,
        domain: PolygonMesh | ArrayLike | None = None,
        rank: int = 300,
        tolerance: float = 1e-3,
    ) -> RandomField:
        """A random map of space, smooth as the kernel is, that agrees with what was observed.

        Its controls are the coefficients of the fields, and standard normal.

        Parameters
        ----------
        seed
            Makes it repeatable.
        domain
            Where it shall vary as the process does: a mesh, or (n, 3) points. Elsewhere it varies less, and far off
            not at all. None = the box of the observations, widened by half its diagonal.
        rank, tolerance
            Fields are added until this part of the variance in the domain is missing, at most so many.

        Raises
        ------
        InvalidParameter
            Neither a domain nor observations.

        Warns
        -----
        PliantWarning
            The rank holds little of the variance.
        """
        fields = self.fields(domain, rank=rank, tolerance=tolerance)
        field = RandomField(fields, prior=self.prior)
        return field.moved(np.random.default_rng(seed).standard_normal(field.controls.shape))

    def draw(self, points: Target, *, seed: int | None = None) -> Points:
        """(n, 3) random displacements of some points, exactly as the process has them.

        They are the symmetric root of the covariance times normal numbers: one seed's fields change gradually as the
        kernel does. For some hundred points, since it takes the cube of their number.

        Parameters
        ----------
        points
            Where: a mesh, or (n, 3).
        seed
            Of the random numbers; None = other ones each time.
        """
        places = as_points(points)
        normal = np.random.default_rng(seed).standard_normal(places.shape)
        if self.kernel.scalar and self.places is None:
            values, vectors = np.linalg.eigh(self.kernel(places, places))
            moved = vectors @ (np.sqrt(np.maximum(values, 0.0))[:, None] * (vectors.T @ normal))
        else:
            values, vectors = np.linalg.eigh(self.covariance(places).reshape(normal.size, -1))
            root = np.sqrt(np.maximum(values, 0.0)) * (vectors.T @ normal.reshape(-1))
            moved = (vectors @ root).reshape(-1, 3)
        return np.asarray(self.mean(places) + moved)

    def fields(
        self, domain: PolygonMesh | ArrayLike | None = None, *, rank: int = 300, tolerance: float = 1e-3
    ) -> LowRank:
        """The process in a domain as few fields: parameters as for :meth:`sample`."""
        prior, _ = pivoted_cholesky(self.kernel, self._domain(domain), rank, tolerance)
        if self.places is None or self.noise is None:
            return prior
        seen = prior.at(self.places).columns()
        size = seen.shape[2]
        errors = np.linalg.cholesky(self.noise.covariances())
        noisy = np.zeros((len(seen), 3, 3 * len(seen)))
        for i, each in enumerate(errors):
            noisy[i, :, 3 * i : 3 * i + 3] = each
        missed = np.concatenate([seen, noisy], axis=2).reshape(3 * len(seen), -1)
        correction = -np.linalg.solve(self._system, missed)
        weights = everywhere(prior.weights) if self.kernel.scalar else prior.weights
        stacked = np.zeros((len(weights) + len(correction), missed.shape[1]))
        stacked[: len(weights), :size] = weights
        stacked[len(weights) :] = correction
        centers = np.vstack([prior.centers, self.places])
        drift = np.vstack([np.zeros_like(prior.centers), self._drift])
        deviations = np.concatenate(
            [np.repeat(prior.deviations, size // len(prior.deviations)), np.ones(3 * len(seen))]
        )
        return LowRank(as_matrices(self.kernel), centers, stacked, deviations, "discrete", prior.kept, drift)

    @property
    def _centers(self) -> Points:
        return np.zeros((1, 3)) if self.places is None else self.places

    @cached_property
    def _drift(self) -> Floats:
        """(m, 3) what the mean sums around the observed places."""
        if self.places is None or self.values is None:
            return np.zeros((1, 3))
        expected = 0.0 if self.prior is None else self.prior(self.places) - self.places
        return np.asarray(np.linalg.solve(self._system, (self.values - expected).reshape(-1)).reshape(-1, 3))

    @cached_property
    def _system(self) -> Floats:
        """(3 m, 3 m) the covariance of the observations."""
        assert self.places is not None
        assert self.noise is not None
        system = self._matrix(self.places, self.places)
        for i, each in enumerate(self.noise.covariances()):
            system[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += each
        return system + _ROUNDING * float(np.trace(system)) / len(system) * np.eye(len(system))

    def _matrix(self, one: Points, two: Points) -> Floats:
        return as_matrices(self.kernel)(one, two).reshape(3 * len(one), 3 * len(two))

    def _domain(self, domain: PolygonMesh | ArrayLike | None) -> Points:
        if domain is not None:
            points = as_points(domain)
            return points[:: -(-len(points) // _MOST)] if len(points) else points
        if self.places is None:
            raise InvalidParameter("nothing was observed: say where the sample shall vary, domain=mesh or points")
        low, high = self.places.min(axis=0), self.places.max(axis=0)
        margin = (float(np.linalg.norm(high - low)) or 1.0) / 2
        axes = [np.linspace(a - margin, b + margin, _GRID) for a, b in zip(low, high, strict=True)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def as_matrices(kernel: Kernel) -> Kernel:
    """The kernel with (3, 3) values."""
    from pliant.shape.matrix_kernels import DirectedKernel

    return DirectedKernel(kernel, np.eye(3)) if kernel.scalar else kernel
