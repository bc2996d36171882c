"""Which control points have to move together so that Bézier patches keep meeting smoothly.

Across a joint, a control point and its two neighbours are collinear, and their distances keep one ratio. A point on
the joint takes its neighbours along; a neighbour moves the one across the other way, by the ratio.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.lattices.patch_block import PatchBlock

Floats = NDArray[np.float64]

STRAIGHT = 1e-6


def smooth_moves(points: Floats, blocks: Sequence[PatchBlock], index: int) -> dict[int, float]:
    """Shares of a control point's move that it and others take, so that joints that are C1 stay so."""
    shares = {index: 1.0}
    for axis in range(3):
        joints = [triple for block in blocks for triple in _inner(block, axis)]
        joints += [triple for block in blocks for triple in _welded(block, blocks, axis)]
        added: dict[int, float] = {}
        for before, joint, after in joints:
            ratio = _ratio(points, before, joint, after)
            if ratio is None:
                continue
            if joint in shares:
                added[before] = added[after] = shares[joint]
            elif before in shares and after not in shares:
                added[after] = -ratio * shares[before]
            elif after in shares and before not in shares:
                added[before] = -shares[after] / ratio
        shares |= {other: share for other, share in added.items() if other not in shares}
    return shares


def joined(blocks: Sequence[PatchBlock]) -> bool:
    """Whether there are joints, inside of blocks or between them."""
    return any(_inner(block, axis) or _welded(block, blocks, axis) for block in blocks for axis in range(3))


def _ratio(points: Floats, before: int, joint: int, after: int) -> float | None:
    """The distance after a joint over that before; None where the three are not on a line, in this order."""
    a, b = points[joint] - points[before], points[after] - points[joint]
    size = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    if not min(size) > 0 or float(a @ b) < (1 - STRAIGHT) * size[0] * size[1]:
        return None
    return size[1] / size[0]


def _inner(block: PatchBlock, axis: int) -> list[tuple[int, int, int]]:
    """(before, joint, after) at the joints between the patches of a block."""
    if block.bases[axis] != "bezier":
        return []
    places = np.moveaxis(block.index, axis, 0)
    first, last = (0, len(places)) if block.wrapped[axis] else (3, len(places) - 1)
    lines = [
        np.stack([places[k - 1], places[k], places[(k + 1) % len(places)]], axis=-1) for k in range(first, last, 3)
    ]
    return _distinct(lines)


def _welded(block: PatchBlock, blocks: Sequence[PatchBlock], axis: int) -> list[tuple[int, int, int]]:
    """(before, joint, after) where an end face of a block belongs to another too."""
    if block.bases[axis] != "bezier" or block.wrapped[axis]:
        return []
    inwards: dict[int, list[int]] = defaultdict(list)
    for other in blocks:
        if other is not block:
            for end, inner in (pair for a in range(3) for pair in _ends(other, a)):
                inwards[end].append(inner)
    return [
        (own, joint, across)
        for joint, own in _ends(block, axis)
        for across in inwards.get(joint, [])
        if len({own, joint, across}) == 3
    ]


def _ends(block: PatchBlock, axis: int) -> list[tuple[int, int]]:
    """Control points on the end faces of an axis, each with its neighbour further in."""
    if block.bases[axis] != "bezier" or block.wrapped[axis]:
        return []
    places = np.moveaxis(block.index, axis, 0)
    pairs = np.concatenate([np.stack([places[e], places[i]], axis=-1).reshape(-1, 2) for e, i in ((0, 1), (-1, -2))])
    return [(int(a), int(b)) for a, b in pairs if a != b]


def _distinct(lines: list[NDArray[np.int64]]) -> list[tuple[int, int, int]]:
    triples = np.concatenate([np.empty((0, 3), np.int64), *(line.reshape(-1, 3) for line in lines)])
    return [(int(a), int(b), int(c)) for a, b, c in triples if len({int(a), int(b), int(c)}) == 3]
