"""A closed surface at some distance around a mesh, whatever the mesh is like: from distances on a grid of cells.

Each cell keeps the nearest of many places on the mesh. Where two cells side by side have nearest places on different
limbs, which face each other, there is a gap between the limbs, however narrow: it is kept open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.cages.extras import import_igl, import_measure
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.triangle_crossings import crossings

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]

_FINEST, _COARSEST = 1 / 170, 1 / 80  # of the diagonal: a cell
_MOST = 2_500_000  # cells
_LEAST_OFFSET = 1.75  # cells
_FACING = -0.2  # the largest cosine between the directions to walls that face each other
_SLIVER = 0.08  # of a cell
_BESIDE = 0.4  # the same, around these
_ROUNDS = 4  # in which gaps that are too narrow for the cells are closed


@dataclass(frozen=True)
class Shell:
    """(n, 3) points and (t, 3) triangles of a closed surface; its distance from the mesh, and the size of a cell."""

    points: Points
    triangles: Indices
    offset: float
    spacing: float


def shell_around(mesh: PolygonMesh, limbs: Indices, offset: float, coarser: float = 1.0) -> Shell:
    """The surface at a distance around a mesh; wider than asked for where cells would not do.

    Parameters
    ----------
    mesh
        What to enclose: open, in pieces, not manifold, cutting itself.
    limbs
        (n,) the limb of each vertex: gaps between different ones are kept open.
    offset
        The distance, in the mesh's unit.
    coarser
        How much larger cells are than they would be.
    """
    low, high = mesh.bounds
    spacing = coarser * float(np.clip(offset / 1.8, _FINEST * mesh.diagonal, _COARSEST * mesh.diagonal))
    spacing = max(spacing, float(np.prod(high - low + 6 * offset) / _MOST) ** (1 / 3))
    offset = max(offset, _LEAST_OFFSET * spacing)
    room = 2 * offset + 4 * spacing
    low = low - room
    shape = np.ceil((high - low + room) / spacing).astype(int) + 1
    distance, limb, towards = _nearest(mesh, limbs, low, spacing, shape)
    solid = _hollows(mesh, distance, low, spacing, offset)
    gap = _gaps(distance, limb, towards, spacing, offset) & ~solid
    distance = _closed(np.where(solid, 0.0, distance), gap, spacing, offset)
    for turn in range(_ROUNDS + 1):
        values = np.where(gap, np.maximum(distance, offset + 0.5 * spacing), distance)
        points, triangles = _surface(_whole(values, distance, spacing, offset), low, spacing, offset)
        if turn == _ROUNDS or not gap.any():
            break
        cut = np.unique(crossings(points, triangles, mesh.points, mesh.triangles)[:, 0])
        if not len(cut):
            break
        gap &= ~_around(points[triangles[cut]].mean(axis=1), low, spacing, shape, turn + 1)
    return Shell(points, triangles, offset, spacing)


def _nearest(
    mesh: PolygonMesh, limbs: Indices, low: Floats, spacing: float, shape: Indices
) -> tuple[Floats, Indices, Floats]:
    """For each cell how far the mesh is, which limb, and (3, ...) the unit vector to there."""
    from scipy.ndimage import distance_transform_edt

    places, triangle = spread_places(mesh.points[mesh.triangles], 0.6 * spacing)
    cell = np.rint((places - low) / spacing).astype(np.int64)
    flat = np.ravel_multi_index(tuple(cell.T), tuple(shape))
    off = ((places - low - cell * spacing) ** 2).sum(axis=1)
    order = np.lexsort([off, flat])
    first = order[np.unique(flat[order], return_index=True)[1]]  # of each cell the place nearest to its middle
    known = np.full(int(np.prod(shape)), -1)
    known[flat[first]] = first
    known = known.reshape(shape)
    at = distance_transform_edt(known < 0, return_distances=False, return_indices=True)
    near = known[tuple(at)]
    towards = np.stack([places[near, i] - (low[i] + spacing * _ramp(shape, i)) for i in range(3)])
    distance = np.sqrt((towards**2).sum(axis=0))
    return distance, limbs[mesh.triangles].max(axis=1)[triangle[near]], towards / np.maximum(distance, 1e-300)


def _ramp(shape: Indices, axis: int) -> Indices:
    form = [1, 1, 1]
    form[axis] = int(shape[axis])
    return np.arange(int(shape[axis])).reshape(form)


def spread_places(corners: Floats, spacing: float) -> tuple[Points, Indices]:
    """Places on (t, 3, 3) triangles that are nowhere farther apart than a distance, and their triangles."""
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    steps = 2 ** np.ceil(np.log2(np.maximum(longest / spacing, 1.0))).astype(int)
    places, triangles = [], []
    for count in np.unique(steps):
        some = np.flatnonzero(steps == count)
        i, j = np.divmod(np.arange((count + 1) ** 2), count + 1)
        i, j = i[i + j <= count], j[i + j <= count]
        weights = np.stack([i, j, count - i - j], axis=1) / count
        places.append(np.einsum("wk,tki->twi", weights, corners[some]).reshape(-1, 3))
        triangles.append(np.repeat(some, len(weights)))
    return np.concatenate(places), np.concatenate(triangles)


def _hollows(mesh: PolygonMesh, distance: Floats, low: Floats, spacing: float, offset: float) -> Mask:
    """Cells beyond the offset that belong inside: the outside does not reach them, or the mesh winds around them."""
    from scipy.ndimage import label

    far = distance > offset
    labels, _ = label(far)
    solid = far & (labels != labels[0, 0, 0])
    if mesh.edge_use[0]:
        where = np.argwhere(far & ~solid)
        points, triangles = np.ascontiguousarray(mesh.points), np.ascontiguousarray(mesh.triangles, np.int64)
        winding = import_igl().fast_winding_number(points, triangles, low + spacing * where)
        solid[tuple(where[np.abs(winding) > 0.5].T)] = True
    return np.asarray(solid)


def _gaps(distance: Floats, limb: Indices, towards: Floats, spacing: float, offset: float) -> Mask:
    """Cells between walls of different limbs that face each other, and around these where they do so less."""
    from scipy.ndimage import binary_propagation

    gap, open_too = np.zeros((2, *distance.shape), bool)
    near = distance <= offset + 2 * spacing
    for axis in range(3):
        one, two = [slice(None)] * 3, [slice(None)] * 3
        one[axis], two[axis] = slice(None, -1), slice(1, None)
        here, there = tuple(one), tuple(two)
        apart = near[here] & near[there] & (limb[here] != limb[there])
        where = np.nonzero(apart)
        cosine = sum(towards[i][here][where] * towards[i][there][where] for i in range(3))
        for most, mask in ((_FACING, gap), (_BESIDE, open_too)):
            apart[where] = cosine < most
            mask[here] |= apart
            mask[there] |= apart
    return np.asarray(binary_propagation(gap, np.ones((3, 3, 3)), open_too))


def _closed(distance: Floats, gap: Mask, spacing: float, offset: float) -> Floats:
    """Distances without crevices and tunnels that no ball of the offset's size fits in, gaps of limbs excepted."""
    from scipy.ndimage import distance_transform_edt

    away = spacing * distance_transform_edt(distance <= 2 * offset)
    kept = gap if not gap.any() else distance_transform_edt(~gap) <= 2 * offset / spacing
    filled = np.minimum(distance, 2 * offset - away + 0.7 * spacing)
    return np.where((filled <= offset) & ~kept, filled, distance)


def _whole(values: Floats, distance: Floats, spacing: float, offset: float) -> Floats:
    """Without bubbles, without islands that hold nothing, and with no value so near to the offset that slivers come."""
    from scipy.ndimage import label

    outer, _ = label(values > offset)
    values = np.where((outer > 0) & (outer != outer[0, 0, 0]), 0.0, values)
    inner, count = label(values <= offset)
    held = np.zeros(count + 1, bool)
    held[inner[distance <= spacing]] = True
    values = np.where((inner > 0) & ~held[inner], offset + spacing, values)
    near = np.abs(values - offset) < _SLIVER * spacing
    return np.where(near, offset + np.where(values > offset, 1, -1) * _SLIVER * spacing, values)


def _surface(values: Floats, low: Floats, spacing: float, offset: float) -> tuple[Points, Indices]:
    points, triangles, _, _ = import_measure().marching_cubes(values, offset, allow_degenerate=False)
    points, triangles = np.asarray(points * spacing + low, np.float64), triangles.astype(np.int64)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    outwards = np.einsum("ti,ti->", a - low, np.cross(b - low, c - low)) > 0
    return points, triangles if outwards else np.ascontiguousarray(triangles[:, ::-1])


def _around(places: Points, low: Floats, spacing: float, shape: Indices, reach: int) -> Mask:
    """The cells around some places."""
    from scipy.ndimage import binary_dilation

    mask = np.zeros(tuple(shape), bool)
    cell = np.clip(np.rint((places - low) / spacing).astype(int), 0, shape - 1)
    mask[tuple(cell.T)] = True
    return np.asarray(binary_dilation(mask, np.ones((3, 3, 3), bool), iterations=reach))
