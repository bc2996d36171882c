"""Models made of models: of fewer points or fields, moved, on another mesh, or with more freedom."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.given import as_numbers
from pliant.shape.basis import FullBasis, ScalarBasis
from pliant.shape.decimation import decimated
from pliant.shape.domain import Interpolation, carriers, submesh
from pliant.shape.kernels import Kernel
from pliant.shape.linear_model import LinearModel
from pliant.shape.pivoted_cholesky import pivoted_cholesky


@dataclass(frozen=True, eq=False, repr=False)
class ChangeableModel(LinearModel):
    """A model that gives others."""

    def marginal(self, vertices: ArrayLike) -> Self:
        """The model of some vertices (m,), with the faces that they span.

        Raises
        ------
        InvalidParameter
            A vertex that the model has not, or one that is named twice.
        """
        chosen = self._indices(vertices)
        if len(np.unique(chosen)) != len(chosen):
            raise InvalidParameter("a vertex is named twice: a model has each once")
        mesh, cells = submesh(self.reference, self.cells, chosen)
        return replace(
            self, reference=mesh, mean=self.mean[chosen], basis=self.basis.rows(chosen), cells=cells, carrier=None
        )

    def decimated(self, count: int) -> Self:
        """The model of at most ``count`` of its vertices, far apart, with triangles between them.

        Raises
        ------
        InvalidParameter
            Fewer than four vertices, or more than there are.
        InvalidMesh
            The model has no faces.
        """
        mesh, kept = decimated(self.reference, count)
        return replace(
            self, reference=mesh, mean=self.mean[kept], basis=self.basis.rows(kept), cells=None, carrier=None
        )

    def truncated(self, rank: int) -> Self:
        """The model of its first fields: those of most variance.

        Raises
        ------
        InvalidParameter
            More fields than there are, or none.
        """
        if not 1 <= rank <= self.rank:
            raise InvalidParameter(f"the model has {self.rank} fields: it cannot be cut to {rank}")
        kept = np.eye(self.rank)[:, :rank]
        deviations = self.basis.deviations[:rank]
        zero = np.zeros(self.count)
        process = self.process and self.process.conditioned(kept, zero, deviations)
        return replace(self, basis=self.basis.combined(kept, deviations), process=process, carrier=None)

    def transformed(self, matrix: ArrayLike) -> Self:
        """The model after an affine map of space: each shape is moved, and has the same coefficients as before.

        Parameters
        ----------
        matrix
            (3, 4) or (4, 4), as :attr:`pliant.Affine.matrix` is.

        Raises
        ------
        InvalidParameter
            Another shape, or numbers that are not finite.
        """
        affine = as_numbers("matrix", matrix, InvalidParameter)
        if affine.shape not in ((3, 4), (4, 4)) or not np.isfinite(affine).all():
            raise InvalidParameter(f"an affine map is a finite (3, 4) or (4, 4) matrix, not {affine.shape}")
        linear, shift = affine[:3, :3], affine[:3, 3]
        return replace(
            self,
            reference=self.reference.with_points(self.reference.points @ linear.T + shift),
            mean=self.mean @ linear.T + shift,
            basis=self.basis.turned(linear),
            process=None,
            carrier=None,
        )

    def with_reference(self, mesh: PolygonMesh) -> Self:
        """The same shapes told as displacements of another mesh, in correspondence with the old reference."""
        return replace(self, reference=mesh, mean=self._corresponding(self.mean), process=None, carrier=None)

    def resampled(self, mesh: PolygonMesh, interpolation: Interpolation = "surface") -> Self:
        """The model on another mesh of the same shape: a decimated or a finer one.

        Where the kernel is known its fields are evaluated at the new vertices; else each follows what is closest on
        the reference.
        """
        if self.process is not None:
            basis = self.process.at(mesh.points)
            shift = self.process.mean(mesh.points)
        else:
            corners, weights = carriers(self.reference, mesh.points, interpolation, self.cells)
            basis = self.basis.rows(corners, weights)
            shift = np.einsum("mc,mcd->md", weights, (self.mean - self.reference.points)[corners])
        return replace(self, reference=mesh, mean=mesh.points + shift, basis=basis, cells=None, carrier=None)

    def augmented(self, kernel: Kernel, *, rank: int | None = None, tolerance: float = 0.0) -> Self:
        """The model with an independent Gaussian process on top: what learnt models need to fit new shapes.

        Raises
        ------
        InvalidParameter
            Neither rank nor tolerance, or a rank below one.
        """
        _, more = pivoted_cholesky(kernel, self.reference.points, rank, tolerance)
        if isinstance(self.basis, ScalarBasis) and isinstance(more, ScalarBasis):
            fields = np.hstack([self.basis.factors, more.factors])
            values, turn = np.linalg.eigh(fields.T @ fields)
            deviations = np.sqrt(np.maximum(values[::-1], 0.0))
            basis = ScalarBasis(fields @ turn[:, ::-1], deviations)
            return replace(self, basis=basis, process=None, convention="discrete", carrier=None)
        columns = np.concatenate([self.basis.columns(), more.columns()], axis=2)
        flat = columns.reshape(3 * len(columns), -1)
        values, turn = np.linalg.eigh(flat.T @ flat)
        full = FullBasis((flat @ turn[:, ::-1]).reshape(columns.shape), np.sqrt(np.maximum(values[::-1], 0.0)))
        return replace(self, basis=full, process=None, convention="discrete", carrier=None)
