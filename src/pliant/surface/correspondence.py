"""Which triangles of two meshes belong together: one mesh is deformed into the other, guided by markers.

The energy of Sumner & Popović (2004, eq. 12): neighbouring triangles deform alike, all deform little, and vertices go
to the closest points of the other mesh that face the same way. The last term's weight is raised step by step, and the
closest points are found anew in each.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, kron

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.closest_triangles import FacingTriangles, unit_normals
from pliant.numerics.meshes.gradients import full_gradients, sound
from pliant.numerics.rigid.rotations import nearest_rotations
from pliant.numerics.sparse.sparse_cholesky import Cholesky
from pliant.surface.constraints import mesh_of

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Progress = Callable[[int, int], None]

_SMOOTHNESS, _IDENTITY = 1.0, 1e-3
_CLOSENESS = (1.0, 17.0, 292.0, 5000.0)
_STAY = 1e-7  # keeps what nothing else determines
STEPS = len(_CLOSENESS) + 2  # of finding a correspondence: one without closest points, and the pairing


def checked_markers(markers: ArrayLike, source: PolygonMesh, target: PolygonMesh) -> Integers:
    """(k, 2) pairs of vertices, source and target.

    Raises
    ------
    InvalidParameter
        Not pairs of integers, none, a vertex that a mesh does not have, or a source vertex that is named twice.
    """
    pairs = np.asarray(markers)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not len(pairs) or not np.issubdtype(pairs.dtype, np.integer):
        raise InvalidParameter(f"markers have shape {pairs.shape} of {pairs.dtype}; (k, 2) vertex indices are needed")
    for column, (name, mesh) in enumerate((("source", source), ("target", target))):
        wrong = np.flatnonzero((pairs[:, column] < 0) | (pairs[:, column] >= len(mesh.points)))
        if len(wrong):
            raise InvalidParameter(
                f"marker {wrong[0]} uses {name} vertex {pairs[wrong[0], column]}; the {name} has "
                f"{len(mesh.points):,} vertices, counted from 0"
            )
    values, counts = np.unique(pairs[:, 0], return_counts=True)
    if (counts > 1).any():
        raise InvalidParameter(f"source vertex {values[counts > 1][0]} is marked twice: a marker has one place")
    return pairs.astype(np.int64)


def find_correspondence(
    source: PolygonMesh, target: PolygonMesh, markers: ArrayLike, progress: Progress | None = None
) -> Integers:
    """Pairs of triangles that belong together.

    Parameters
    ----------
    source, target
        Meshes of any connectivity, in similar poses.
    markers
        (k, 2) pairs of vertices, source and target: a dozen or more, at what the shapes have in common.
    progress
        Called with the number of steps done, and of all. What it raises ends the work.

    Returns
    -------
    ndarray
        (c, 2) source and target triangles, sorted by target; every target triangle occurs.
    """
    pairs = checked_markers(markers, mesh_of(source, "transfer"), mesh_of(target, "transfer"))
    deformed = fitted(source, target, pairs, progress)
    forward = _nearest(deformed, source.triangles, target.points, target.triangles)
    back = _nearest(target.points, target.triangles, deformed, source.triangles)
    one = np.column_stack([np.arange(len(forward)), forward])[forward >= 0]
    two = np.column_stack([back, np.arange(len(back))])
    both = np.unique(np.vstack([one, two]), axis=0)
    if progress is not None:
        progress(STEPS, STEPS)
    return both[np.argsort(both[:, 1], kind="stable")]


def fitted(source: PolygonMesh, target: PolygonMesh, markers: Integers, progress: Progress | None = None) -> Points:
    """(n, 3) the source's vertices, deformed into the target's shape."""
    unit = target.diagonal or 1.0
    start, rest = _aligned(source.points, target.points, markers) / unit, target.points / unit
    triangles, count = source.triangles, len(source.points)
    gradients = full_gradients(start, triangles)
    usable = np.repeat(sound(start, triangles), 3).astype(np.float64)
    differences = csr_array(kron(_neighbors(start, triangles), eye_array(3), format="csr") @ gradients)
    system = _SMOOTHNESS * (differences.T @ differences) + _IDENTITY * (gradients.T @ gradients)
    right = _IDENTITY * (gradients.T @ (usable[:, None] * np.tile(np.eye(3), (len(triangles), 1))))
    stay = np.full(system.shape[0], _STAY)
    begin = np.vstack([start, np.zeros((len(triangles), 3))])
    free = np.setdiff1d(np.arange(system.shape[0]), markers[:, 0])
    surface, result, factor = FacingTriangles(rest, target.triangles), begin, None
    for done, weight in enumerate((0.0, *_CLOSENESS), 1):
        pull, goal = np.zeros(system.shape[0]), np.zeros_like(begin)
        if weight:
            goal[:count], triangle = surface.closest(result[:count], _normals(source, result[:count]))
            pull[:count] = weight * (triangle >= 0)
        result = begin.copy()
        result[markers[:, 0]] = rest[markers[:, 1]]
        matrix = csr_array(system + diags_array(stay + pull))
        wanted = right + stay[:, None] * begin + pull[:, None] * goal
        wanted = wanted[free] - matrix[free][:, markers[:, 0]] @ result[markers[:, 0]]
        inner = csc_array(matrix[free][:, free])
        factor = Cholesky(inner) if factor is None else factor.refactored(inner)
        result[free] = factor.solve(wanted)
        if progress is not None:
            progress(done, STEPS)
    return result[:count] * unit


def _aligned(points: Points, goal: Points, markers: Integers) -> Points:
    """Points under the similarity that brings their markers nearest to where they belong (Umeyama 1991)."""
    one, two = points[markers[:, 0]], goal[markers[:, 1]]
    middle, aim = one.mean(axis=0), two.mean(axis=0)
    rotation = nearest_rotations(((two - aim).T @ (one - middle))[None])[0]
    size = float(((one - middle) ** 2).sum())
    scale = float(np.sqrt(((two - aim) ** 2).sum() / size)) if size > 0 else 1.0
    return np.asarray((scale or 1.0) * (points - middle) @ rotation.T + aim)


def _neighbors(points: Points, triangles: NDArray[np.int32]) -> csr_array:
    """(p, t) one row a pair of sound triangles with a side in common: 1 and -1."""
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(triangles)), 3)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    same = (sides[order][1:] == sides[order][:-1]).all(axis=1)
    one, two = owner[order][:-1][same], owner[order][1:][same]
    usable = sound(points, triangles)
    keep = usable[one] & usable[two]
    one, two, rows = one[keep], two[keep], np.arange(int(keep.sum()))
    values = np.repeat([1.0, -1.0], len(rows))
    return csr_array((values, (np.tile(rows, 2), np.concatenate([one, two]))), shape=(len(rows), len(triangles)))


def _normals(mesh: PolygonMesh, points: Points) -> Points:
    return mesh.with_points(points).vertex_normals


def _nearest(points: Points, triangles: NDArray[np.int32], others: Points, other: NDArray[np.int32]) -> Integers:
    """(t,) for each triangle the one of the others nearest to its middle that faces the same way; else any nearest."""
    middle, normals = points[triangles].mean(axis=1), unit_normals(points, triangles)
    surface = FacingTriangles(others, other)
    _, found = surface.closest(middle, normals)
    lost = np.flatnonzero(found < 0)
    if len(lost):
        from scipy.spatial import cKDTree

        found[lost] = cKDTree(others[other].mean(axis=1)).query(middle[lost])[1]
    return found
