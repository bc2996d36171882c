"""Low-rank processes: a covariance kernel as a sum of few fields, u(x) = sum_j a_j ψ_j(x) with a_j ~ N(0, 1).

The fields are ψ(x) = k(x, centers) weights: known exactly everywhere, on a mesh or off it. A scalar kernel has scalar
fields, one for all three coordinates; its rank counts those.

They come from pivoted Cholesky, :mod:`pliant.shape.pivoted_cholesky`, or from the Nyström method, which takes the
eigenvectors of the covariance between sample points (Lüthi et al. 2018, section 3.2).
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pliant.errors import InvalidParameter, PliantWarning
from pliant.numerics.given import as_count, as_number
from pliant.shape.basis import Basis, FullBasis, ScalarBasis, everywhere
from pliant.shape.expansion import expansion, expansion_slopes
from pliant.shape.kernels import Floats, Kernel
from pliant.shape.matrix_kernels import DirectedKernel

Convention = Literal["discrete", "continuous"]

NEGLIGIBLE = 1e-12  # variance relative to the largest, below which a pivot is rounding
LITTLE = 0.8  # part of the variance below which a basis is said to miss much
MOST = 5_000  # fields, where only a tolerance is given


@dataclass(frozen=True, eq=False)
class LowRank:
    """Fields ψ(x) = k(x, centers) weights.

    Parameters
    ----------
    kernel
        The kernel.
    centers
        (p, 3).
    weights
        (p, r) for a scalar kernel; (3 p, r) for a matrix-valued one.
    deviations
        (r,) the standard deviation of each field: the square root of its eigenvalue, descending.
    convention
        What the eigenvalues are of: ``"discrete"``, the covariance matrix of all points; ``"continuous"``, that matrix
        over their number, which does not grow with it. The two are not comparable.
    kept
        Part of the variance that the fields have.
    drift
        (p, 3) the mean displacement is k(x, centers) drift; None = zero.
    """

    kernel: Kernel
    centers: Floats
    weights: Floats
    deviations: Floats
    convention: Convention
    kept: float = 1.0
    drift: Floats | None = None

    def at(self, points: Floats) -> Basis:
        """The fields at (n, 3) points."""
        covariance = self.kernel(points, self.centers)
        if self.kernel.scalar:
            return ScalarBasis(covariance @ self.weights, self.deviations)
        columns = covariance.reshape(3 * len(points), 3 * len(self.centers)) @ self.weights
        return FullBasis(columns.reshape(len(points), 3, len(self.deviations)), self.deviations)

    def mean(self, points: Floats) -> Floats:
        """(n, 3) the mean displacement at (n, 3) points."""
        if self.drift is None:
            return np.zeros_like(points)
        return expansion(self.kernel, points, self.centers, self.drift)

    def slopes(self, points: Floats, coefficients: Floats) -> Floats:
        """(n, 3, 3) the derivative of the displacement that (k,) coefficients make, at (n, 3) points."""
        values = self._values(coefficients)
        return expansion_slopes(
            self.kernel, points, self.centers, values if self.drift is None else values + self.drift
        )

    def conditioned(self, matrix: Floats, coefficients: Floats, deviations: Floats) -> LowRank:
        """The fields ψ M, about the mean that (k,) coefficients of the old fields make."""
        drift = self._values(coefficients) + (0.0 if self.drift is None else self.drift)
        if len(matrix) == self.weights.shape[1]:
            return replace(self, weights=self.weights @ matrix, deviations=deviations, drift=drift)
        kernel = DirectedKernel(self.kernel, np.eye(3))  # coordinates that depend on each other
        return replace(
            self, kernel=kernel, weights=everywhere(self.weights) @ matrix, deviations=deviations, drift=drift
        )

    def _values(self, coefficients: Floats) -> Floats:
        """(p, 3) what is summed at the centres."""
        flat = coefficients.reshape(-1, 3) if self.kernel.scalar else coefficients
        return np.asarray((self.weights @ flat).reshape(-1, 3))


def nystrom(kernel: Kernel, samples: Floats, rank: int | None = None, tolerance: float = 0.0) -> LowRank:
    """Fields from the eigenvectors of the covariance between (m, 3) samples; parameters as for pivoted Cholesky.

    Raises
    ------
    InvalidParameter
        A rank below one, or a tolerance outside [0, 1).

    Warns
    -----
    PliantWarning
        The rank holds little of the variance; how much is said.
    """
    covariance = kernel(samples, samples)
    size = len(samples) * (1 if kernel.scalar else 3)
    values, vectors = np.linalg.eigh(covariance.reshape(size, size))
    values, vectors = values[::-1], vectors[:, ::-1]
    most = checked_rank(size, rank, tolerance, 0.0)
    total = float(values.sum())
    enough = 1 + int(np.searchsorted(np.cumsum(values) / total, 1 - tolerance)) if tolerance else most
    take = min(most, enough, int((values > NEGLIGIBLE * values[0]).sum()))
    values, kept = values[:take], float(values[:take].sum()) / total
    warn_of_little(kept, take)
    deviations = np.sqrt(values / len(samples))
    return LowRank(kernel, samples, vectors[:, :take] / np.sqrt(values), deviations, "continuous", kept)


def checked_rank(size: int, rank: int | None, tolerance: float, absolute: float) -> int:
    """The most fields that there may be.

    Raises
    ------
    InvalidParameter
        Nothing said, a rank below one, or a tolerance outside [0, 1).
    """
    if rank is not None and as_count("the rank", rank, InvalidParameter) < 1:
        raise InvalidParameter(f"the rank is {rank}; a model needs at least one field")
    tolerance, absolute = (as_number("the tolerance", each, InvalidParameter) for each in (tolerance, absolute))
    if not 0 <= tolerance < 1 or absolute < 0:
        raise InvalidParameter(f"the tolerance is {tolerance}, a part of the variance: from 0 to below 1")
    if rank is None and not tolerance and not absolute:
        raise InvalidParameter("say how many fields there shall be: rank=, or tolerance=")
    return min(size, MOST if rank is None else rank)


def warn_of_little(kept: float, rank: int) -> None:
    """Warn where the fields hold little of the variance; the caller's caller is named."""
    if kept < LITTLE:
        warnings.warn(
            f"{rank} fields hold {100 * kept:.0f} % of the variance: the kernel varies over too short distances; use a "
            "higher rank, a larger sigma, or tolerance=",
            PliantWarning,
            stacklevel=3,
        )
