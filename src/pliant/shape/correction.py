"""What observations add to coefficients: a ↦ a + K (y − Q a), with the gain K = M⁻¹ Qᵀ Σ⁻¹ of the posterior mean.

Coefficients of a random shape become those of a random shape that agrees with the observations, to their noise
(Matheron's rule; Wilson et al. 2020, eq. 4); coefficients that agree already stay as they are.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape.basis import Basis, Floats
from pliant.shape.posterior import Noise


class Correction:
    """The gain K, for observations whose places and noise are known.

    Parameters
    ----------
    observed
        The fields Q at the observed points.
    noise
        Of the observations.
    """

    def __init__(self, observed: Basis, noise: Noise) -> None:
        self._observed, self._noise = observed, noise
        with one_blas_thread():
            gram = observed.gram(noise.precision)
            self._lower = np.asarray(np.linalg.cholesky(gram + np.eye(len(gram))), np.float64)

    def __call__(self, coefficients: Floats, residual: Floats) -> Floats:
        """(k,) coefficients, corrected by (m, 3) observations less the mean there."""
        missed = residual - np.asarray(self._observed.apply(coefficients), np.float64)
        return coefficients + self.gain(missed)

    def gain(self, residual: Floats) -> Floats:
        """(k,) K times (m, 3) values."""
        return self._solved(self._observed.transpose(self._noise.weighted(residual)))

    def gain_transposed(self, coefficients: Floats) -> Floats:
        """(m, 3) Kᵀ times (k,) values."""
        return self._noise.weighted(np.asarray(self._observed.apply(self._solved(coefficients)), np.float64))

    def transposed(self, coefficients: Floats) -> Floats:
        """(k,) the transpose of the correction's linear part, 1 − K Q."""
        return coefficients - self._observed.transpose(self.gain_transposed(coefficients))

    def _solved(self, right: Floats) -> Floats:
        from scipy.linalg import cho_solve

        columns = right.reshape(len(self._lower), -1)
        with one_blas_thread():
            found = cho_solve((self._lower, True), columns, check_finite=False)
        return np.asarray(found, np.float64).reshape(-1)
