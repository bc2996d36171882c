"""ShapeModel: a shape that varies, as a mean and fields with normal coefficients (Lüthi et al. 2018).

A shape of the model is mean + sum_j a_j ψ_j with a_j ~ N(0, 1). Models are immutable; each method that changes one
gives another.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Deformer
from pliant.errors import InvalidMesh, InvalidParameter
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.shape.basis import Basis, Floats
from pliant.shape.domain import Interpolation, Where, observed_rows
from pliant.shape.fitted_model import FittedModel
from pliant.shape.kernels import Kernel
from pliant.shape.low_rank import nystrom
from pliant.shape.pivoted_cholesky import pivoted_cholesky
from pliant.shape.posterior import Noise, condition, log_likelihood, most_likely, warn_of_contradictions
from pliant.shape.surface_samples import Spread, surface_samples


@dataclass(frozen=True, eq=False, repr=False)
class ShapeModel(FittedModel):
    """A statistical model of a shape: triangle or polygon meshes, tetrahedra, lines, or bare points.

    Parameters
    ----------
    reference
        The shape's mesh, whose connectivity all shapes of the model share.
    mean
        (n, 3) the mean shape.
    basis
        The fields at the points.
    process
        The same fields everywhere in space, where the kernel is known.
    cells
        (m, 4) tetrahedra of a volume mesh.
    convention
        What the eigenvalues are of: ``"discrete"``, the covariance of all points; ``"continuous"``, that over their
        number.
    noise_variance
        Of a model that was learnt: what its fields do not explain, a length squared.
    carrier
        What a reader kept in order to write the same file again. Opaque.

    Raises
    ------
    InvalidMesh
        A mean, or fields, of another number of points than the reference.
    """

    @classmethod
    def from_kernel(
        cls,
        mesh: PolygonMesh,
        kernel: Kernel,
        *,
        rank: int | None = None,
        tolerance: float = 0.0,
        method: Literal["cholesky", "nystrom"] = "cholesky",
        samples: int | None = None,
        spread: Spread = "area",
        seed: int = 0,
    ) -> Self:
        """A model around a mesh whose displacements have a covariance.

        Parameters
        ----------
        mesh
            The mean.
        kernel
            The covariance of displacements; ``scale`` is an amplitude, a length.
        rank
            How many fields; those of a scalar kernel serve all three coordinates.
        tolerance
            Or: as many as it takes for no more than this part of the variance to be missing.
        method
            ``"cholesky"``: pivots, accurate at the vertices. ``"nystrom"``: eigenvectors of the covariance between
            sample points; eigenvalues do not depend on the number of vertices.
        samples
            For Nyström, how many points; None = 4 times the rank, at least 300.
        spread, seed
            For Nyström, where: see :func:`~pliant.shape.surface_samples.surface_samples`.

        Raises
        ------
        InvalidParameter
            Neither rank nor tolerance, a rank below one, an unknown word.

        Warns
        -----
        PliantWarning
            The rank holds little of the variance; how much is said.
        """
        if method not in ("cholesky", "nystrom"):
            raise InvalidParameter(f"a model is made by 'cholesky' or 'nystrom', not by {method!r}")
        if not len(mesh.points):
            raise InvalidMesh("a mesh without points has no shape to vary")
        if method == "cholesky":
            process, basis = pivoted_cholesky(kernel, mesh.points, rank, tolerance)
        else:
            count = samples or max(300, 4 * (rank or 0))
            process = nystrom(kernel, surface_samples(mesh, count, spread, seed), rank, tolerance)
            basis = process.at(mesh.points)
        return cls(mesh, mesh.points, basis, process, convention=process.convention)

    def posterior(self, where: Where, positions: ArrayLike, *, noise: ArrayLike) -> Self:
        """The model that knows where some points are (Lüthi et al. 2018, section 3.4).

        Parameters
        ----------
        where
            (m,) vertex indices, or (m, 3) points on, or near, the reference.
        positions
            (m, 3) where they were seen.
        noise
            Of the observations: a standard deviation (a length), (m,) of them, or (m, 3, 3) covariance matrices, as
            :func:`~pliant.shape.posterior.along_and_across` makes them.

        Raises
        ------
        InvalidParameter
            An index that the model has not, noise that is not positive, another number of positions.

        Warns
        -----
        PliantWarning
            Observations of one place contradict each other.
        """
        observed, residual, error = self._observed(where, positions, noise)
        found = condition(observed, residual, error)
        mean = self.mean + np.asarray(self.basis.apply(found.mean), np.float64)
        process = self.process and self.process.conditioned(found.matrix, found.mean, found.deviations)
        return replace(
            self, mean=mean, basis=self.basis.combined(found.matrix, found.deviations), process=process, carrier=None
        )

    def posterior_mean(self, where: Where, positions: ArrayLike, *, noise: ArrayLike) -> Points:
        """(n, 3) the most likely shape given observations, as for :meth:`posterior`, but much faster.

        Parameters
        ----------
        where
            As for :meth:`posterior`.
        positions
            (m, 3) where it was seen.
        noise
            As for :meth:`posterior`.
        """
        observed, residual, error = self._observed(where, positions, noise)
        return self.instance(most_likely(observed, residual, error))

    def log_likelihood(self, where: Where, positions: ArrayLike, *, noise: ArrayLike) -> float:
        """The marginal likelihood of observations, as for :meth:`posterior`: its logarithm.

        Parameters
        ----------
        where
            As for :meth:`posterior`.
        positions
            (m, 3) where it was seen.
        noise
            As for :meth:`posterior`.
        """
        return log_likelihood(*self._observed(where, positions, noise))

    def deformer(
        self, coefficients: ArrayLike | None = None, *, interpolation: Interpolation | None = None
    ) -> Deformer:
        """The model as a deformer whose controls are its (k,) coefficients; None = at the mean.

        Where the kernel is known it is a map of all of space. Else it moves meshes in correspondence with the
        model; with an interpolation it moves any points, by those of the reference that are nearest.

        Parameters
        ----------
        coefficients
            In standard deviations.
        interpolation
            ``"nearest"`` vertex, ``"surface"``: the closest point of the surface, or ``"tetrahedra"``: where a point
            lies in a volume mesh.
        """
        from pliant.shape.model_deformer import ModelDeformer
        from pliant.shape.random_field import RandomField

        if self.process is not None and interpolation is None:
            return RandomField(self.process, coefficients)
        return ModelDeformer(self, coefficients, interpolation)

    def _observed(self, where: Where, positions: ArrayLike, noise: ArrayLike) -> tuple[Basis, Floats, Noise]:
        places, basis, mean = observed_rows(self, where)
        seen = as_points(positions)
        if len(seen) != len(mean):
            raise InvalidParameter(f"{len(mean)} points were observed at {len(seen)} positions: each needs one")
        error = Noise.of(noise, len(seen))
        warn_of_contradictions(places, seen, error)
        return basis, seen - mean, error
