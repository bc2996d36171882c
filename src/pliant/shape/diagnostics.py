"""Whether chains have converged: split R-hat and effective sample sizes (Gelman et al. 2013, section 11.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter

Floats = NDArray[np.float64]


def r_hat(samples: Floats) -> Floats:
    """(k,) how much wider all chains together are than each half of one: 1 when converged.

    Parameters
    ----------
    samples
        (chains, draws, k) states, as ``metropolis_hastings(...).samples``.
    """
    _, within, together = _variances(samples)
    return np.asarray(np.sqrt(np.divide(together, within, out=np.full_like(within, np.inf), where=within > 0)))


def effective_sample_size(samples: Floats) -> Floats:
    """(k,) how many independent draws are worth as much, by Geyer's initial positive sequence.

    Parameters
    ----------
    samples
        (chains, draws, k) states, as ``metropolis_hastings(...).samples``.
    """
    halves, _, together = _variances(samples)
    count, draws, _ = halves.shape
    centered = halves - halves.mean(axis=1, keepdims=True)
    size = 1 << (2 * draws - 1).bit_length()
    spectrum = np.fft.rfft(centered, size, axis=1)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2, size, axis=1)[:, :draws].mean(axis=0) / draws
    within = covariance[0] * draws / (draws - 1)
    safe = np.where(together > 0, together, 1.0)
    correlation = 1 - (within - covariance) / safe
    correlation[0] = 1.0
    pairs = correlation[: draws - draws % 2].reshape(-1, 2, correlation.shape[1]).sum(axis=1)
    kept = np.minimum.accumulate(np.where(np.logical_and.accumulate(pairs > 0, axis=0), pairs, 0.0), axis=0)
    length = np.maximum(2 * kept.sum(axis=0) - 1, 1 / np.log10(max(10, count * draws)))
    return np.asarray(np.where(together > 0, count * draws / length, 1.0))


def _variances(samples: Floats) -> tuple[Floats, Floats, Floats]:
    """Halves of the chains, the mean variance within them, and the estimate of that of all."""
    array = np.asarray(samples, np.float64)
    if array.ndim != 3 or array.shape[1] < 4:
        raise InvalidParameter(f"chains are (chains, draws, k) with four draws or more, not {array.shape}")
    draws = array.shape[1] // 2
    halves = np.concatenate([array[:, :draws], array[:, -draws:]])
    within = halves.var(axis=1, ddof=1).mean(axis=0)
    together = within * (draws - 1) / draws + halves.mean(axis=1).var(axis=0, ddof=1)
    return halves, np.asarray(within), np.asarray(together)
