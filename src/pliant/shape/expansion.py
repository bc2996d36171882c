"""Sums of kernels around centres: what means, samples and posteriors of Gaussian processes are made of."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.chunks import for_chunks
from pliant.shape.kernels import Floats, Kernel

_BLOCK = 131_072  # covariances a block


def expansion(kernel: Kernel, points: Floats, centers: Floats, values: Floats) -> Floats:
    """(n, 3) the sum over (p, 3) centres of k(x, center) times (p, 3) values; no large matrix is made."""
    out = np.empty((len(points), 3))

    def work(first: int, stop: int) -> None:
        covariance = kernel.block(points[first:stop], centers)
        if kernel.scalar:
            out[first:stop] = covariance @ values
        else:
            out[first:stop] = np.einsum("ncpd,pd->nc", covariance, values)

    for_chunks(work, len(points), max(1, _BLOCK // max(1, len(centers))))
    return out


def expansion_slopes(kernel: Kernel, points: Floats, centers: Floats, values: Floats) -> Floats:
    """(n, 3, 3) the derivative of :func:`expansion` by position: row = coordinate of the displacement."""
    out = np.empty((len(points), 3, 3))
    signature = "npk,pc->nck" if kernel.scalar else "ncpdk,pd->nck"

    def work(first: int, stop: int) -> None:
        out[first:stop] = np.einsum(signature, kernel.slopes(points[first:stop], centers), values, optimize=True)

    for_chunks(work, len(points), max(1, _BLOCK // max(1, 3 * len(centers))))
    return out
