"""Sums of radial functions around centres: values, derivatives, and the transpose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.maps.full_lanes import LANES, filled
from pliant.numerics.ragged import source

Floats = NDArray[np.float64]

CHUNK = 16_384  # points a chunk: hundreds of centres are work enough


@dataclass(frozen=True, eq=False)
class RadialBasis:
    """phi(scale |x - c|) around centres c.

    Parameters
    ----------
    centers
        (k, 3).
    scale
        What distances are multiplied with.
    compact
        Wendland's C² function (1 - r)^4 (4 r + 1), zero from r = 1 on (Wendland 1995); else -r, the thin plate in
        three dimensions.
    """

    centers: Floats
    scale: float
    compact: bool

    def sum(self, points: Floats, values: Floats, linear: Floats, base: Floats, out: Floats) -> None:
        """Out (n, 3) = base + linear (3, 4) at the points + the sum of phi times (k, 3) values."""
        from pliant.numerics.maps.radial_kernels import radial_sum

        if len(points) < LANES:
            few = np.empty((LANES, 3))
            if len(points):
                self.sum(filled(points), values, linear, filled(base), few)
            out[:] = few[: len(points)]
            return
        flat, under, target = source(points.reshape(-1)), source(base.reshape(-1)), out.reshape(-1)
        centers, weights = self.centers.reshape(-1), values.reshape(-1)
        for_chunks(
            lambda first, stop: radial_sum(
                flat, first, stop, centers, self.scale, self.compact, weights, linear, under, target
            ),
            len(points),
            CHUNK,
        )

    def slopes(self, points: Floats, values: Floats, linear: Floats) -> Floats:
        """(n, 3, 3) linear (3, 3) + the derivative of the sum by position; at a tip that of the other centres."""
        from pliant.numerics.maps.radial_kernels import radial_slopes

        out = np.empty((max(len(points), LANES), 3, 3))
        flat, target = filled(points).reshape(-1), out.reshape(-1)
        centers, weights = self.centers.reshape(-1), values.reshape(-1)
        for_chunks(
            lambda first, stop: radial_slopes(
                flat, first, stop, centers, self.scale, self.compact, weights, linear, target
            ),
            len(out) if len(points) else 0,
            CHUNK,
        )
        return out[: len(points)]

    def gather(self, points: Floats, values: Floats) -> Floats:
        """(k, 3) for each centre the sum over the points of phi times (n, 3) values."""
        from pliant.numerics.maps.radial_kernels import radial_gather

        spare = -len(points) % LANES
        flat = np.vstack([points, np.zeros((spare, 3))]).reshape(-1)
        given = np.vstack([values, np.zeros((spare, 3))]).reshape(-1)
        pieces = -(-len(flat) // (3 * CHUNK))
        sums, centers = np.zeros((pieces, *self.centers.shape)), self.centers.reshape(-1)

        def work(first: int, stop: int) -> None:
            target = sums[first // CHUNK].reshape(-1)
            radial_gather(flat, first, stop, centers, self.scale, self.compact, given, target)

        for_chunks(work, len(flat) // 3, CHUNK)
        return np.asarray(sums.sum(axis=0))

    def matrix(self) -> Floats:
        """(k, k) phi between the centres."""
        difference = self.centers[:, None] - self.centers[None]
        r = self.scale * np.sqrt((difference**2).sum(axis=2))
        return np.asarray(np.clip(1 - r, 0, 1) ** 4 * (4 * r + 1) if self.compact else -r)
