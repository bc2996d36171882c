"""Lattices of different shapes welded into one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pliant.errors import InvalidDeformer
from pliant.space.extended_ffd import ExtendedFFD

WELD = 1e-6


def merge(first: ExtendedFFD, second: ExtendedFFD, tolerance: float = WELD) -> ExtendedFFD:
    """One lattice from two: control points that are in the same place at rest become one.

    A point that both contain follows the first. Where a whole face is shared, deformations stay continuous across
    it, and :meth:`ExtendedFFD.moved_smoothly` keeps them smooth.

    Parameters
    ----------
    first, second
        The lattices. The first one's policy for points outside is kept.
    tolerance
        Distance below which control points are in the same place, relative to the diagonal of both.

    Returns
    -------
    ExtendedFFD
        With the first one's control points, followed by those that only the second has.

    Raises
    ------
    InvalidDeformer
        Control points that would be welded are displaced differently.
    """
    from scipy.spatial import cKDTree

    everything = np.concatenate([first.rest, second.rest])
    reach = tolerance * float(np.linalg.norm(np.ptp(everything, axis=0)))
    distance, twin = cKDTree(first.rest).query(second.rest, distance_upper_bound=max(reach, 1e-300))
    welded = np.isfinite(distance)
    new = len(first.rest) + np.cumsum(~welded) - 1
    place = np.where(welded, twin, new)
    one, two = first.controls - first.rest, second.controls - second.rest
    differ = np.flatnonzero(np.linalg.norm(two[welded] - one[twin[welded]], axis=1) > reach)
    if len(differ):
        at = np.flatnonzero(welded)[differ[0]]
        raise InvalidDeformer(
            f"control point {twin[at]} of the first lattice and {at} of the second are in the same place, but are "
            f"displaced differently ({len(differ)} pairs are): merge lattices at rest, then move them"
        )
    assert first.frames is not None
    assert second.frames is not None
    return replace(
        first,
        points=np.concatenate([first.rest, second.rest[~welded]]),
        displacements=np.concatenate([one, two[~welded]]),
        blocks=first.blocks + tuple(replace(block, index=place[block.index]) for block in second.blocks),
        frames=first.frames + second.frames,
    )
