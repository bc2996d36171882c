"""Maps that carry each section of space by an affine map of its own: Barr's deformations, seen at once.

In a frame of its own a point has coordinates (u, v, s): two across an axis, one along it. A section is all points
with the same q: q = s gives planes across the axis, q = r = |(u, v)| gives tubes around it. The map adds

    d_i = T_i0(q) + T_i1(q) u + T_i2(q) v,    i = u, v, s,

so that its derivative needs the entries T_ij and their derivatives by q, and nothing else. Points go through in spans
that stay in the cache.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.maps.full_lanes import LANES, filled

Floats = NDArray[np.float64]
Entries = Mapping[tuple[int, int], Any]
"""The T_ij that are not zero, by (i, j): arrays shaped as q, or numbers."""
Profile = tuple[Floats, Floats]
"""From s to the profile's variable, and its cubic pieces: see :mod:`pliant.numerics.maps.section_kernels`."""

SPAN = 16_384  # points a span: its tables stay in the second-level cache


def section_of(points: Floats, frame: Floats, radial: bool = False) -> Floats:
    """(n,) the q of each of (n, 3) points: s, or r where ``radial``."""
    from pliant.numerics.maps import section_kernels

    result = np.empty(max(len(points), LANES))
    flat = filled(points).reshape(-1)
    for_spans(
        lambda first, stop: section_kernels.measure(flat, first, stop, frame, radial, result[first:stop]), len(result)
    )
    return result[: len(points)]


def displaced(
    points: Floats, frame: Floats, entries: Callable[[Floats], Entries], base: Floats, out: Floats, radial: bool = False
) -> bool:
    """Out (n, 3) = base (n, 3) + the displacement of (n, 3) points; all in C order. Tells whether all is finite."""
    from pliant.numerics.maps import section_kernels

    if len(points) < LANES:
        few = np.empty((LANES, 3))
        finite = not len(points) or displaced(filled(points), frame, entries, filled(base), few, radial)
        out[:] = few[: len(points)]
        return finite
    flat, under, target = points.reshape(-1), base.reshape(-1), out.reshape(-1)
    doubts: list[float] = []

    def work(first: int, stop: int) -> None:
        q = np.empty(stop - first)
        section_kernels.measure(flat, first, stop, frame, radial, q)
        table, rows = _tabulated(entries(q), stop - first)
        doubts.append(section_kernels.displace(flat, first, stop, frame, table, rows, under, target))

    for_spans(work, len(points))
    return sum(doubts) == 0.0


def jacobians(
    points: Floats,
    frame: Floats,
    entries: Callable[[Floats], Entries],
    slopes: Callable[[Floats], Entries],
    radial: bool = False,
) -> Floats:
    """(n, 3, 3) the derivative of x + displacement at (n, 3) points."""
    from pliant.numerics.maps import section_kernels

    count = len(points)
    out = np.empty((max(count, LANES), 3, 3))
    flat, target = filled(points).reshape(-1), out.reshape(-1)

    def work(first: int, stop: int) -> None:
        q = np.empty(stop - first)
        section_kernels.measure(flat, first, stop, frame, radial, q)
        table, rows = _tabulated(entries(q), stop - first)
        steep, steep_rows = _tabulated(slopes(q), stop - first)
        section_kernels.differentiate(flat, first, stop, frame, table, rows, steep, steep_rows, q, radial, target)

    for_spans(work, len(out) if count else 0)
    return out[:count]


def similar(points: Floats, frame: Floats, profile: Profile, angle: float, growth: float, out: Floats) -> bool:
    """Out (n, 3) = points whose sections turn by angle h(t) and grow by 1 + growth h(t); faster than a table.

    Tells whether all is finite.
    """
    from pliant.numerics.maps import section_kernels

    if len(points) < LANES:
        few = np.empty((LANES, 3))
        finite = not len(points) or similar(filled(points), frame, profile, angle, growth, few)
        out[:] = few[: len(points)]
        return finite
    flat, target = points.reshape(-1), out.reshape(-1)
    doubts: list[float] = []

    def work(first: int, stop: int) -> None:
        doubts.append(section_kernels.similar(flat, first, stop, frame, *profile, angle, growth, target))

    for_chunks(work, len(points))
    return sum(doubts) == 0.0


def similar_jacobians(points: Floats, frame: Floats, profile: Profile, angle: float, growth: float) -> Floats:
    """(n, 3, 3) the derivative of :func:`similar`."""
    from pliant.numerics.maps import section_kernels

    out = np.empty((max(len(points), LANES), 3, 3))
    flat, target = filled(points).reshape(-1), out.reshape(-1)
    for_chunks(
        lambda first, stop: section_kernels.similar_slopes(flat, first, stop, frame, *profile, angle, growth, target),
        len(out) if len(points) else 0,
    )
    return out[: len(points)]


def for_spans(work: Callable[[int, int], None], count: int) -> None:
    """Call ``work(first, stop)`` for spans of at least eight points, on all processors."""
    spans = max(1, count // SPAN)
    edges = [count * k // spans for k in range(spans + 1)]

    def several(first: int, stop: int) -> None:
        for k in range(first, stop):
            work(edges[k], edges[k + 1])

    for_chunks(several, spans if count else 0, 4)


def _tabulated(entries: Entries, count: int) -> tuple[Floats, NDArray[np.int64]]:
    """The entries one after another, and where each begins, or -1."""
    table, rows = np.empty((max(len(entries), 1), count)), np.full(9, -1)
    for row, ((i, j), values) in enumerate(entries.items()):
        table[row] = values
        rows[3 * i + j] = row * count
    return table.reshape(-1), rows
