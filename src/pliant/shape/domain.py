"""Where a model is observed: at vertices, or at free points near its surface."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.ragged import Ragged
from pliant.shape.basis import Basis, Floats

if TYPE_CHECKING:
    from pliant.shape.linear_model import LinearModel

Interpolation = Literal["nearest", "surface", "tetrahedra"]
Where = ArrayLike


def observed_rows(model: LinearModel, where: Where) -> tuple[Floats, Basis, Points]:
    """The places on the reference (m, 3), the fields there, and the mean there (m, 3).

    Raises
    ------
    InvalidParameter
        An index that the model has not, or an array that is neither indices nor points.
    """
    given = np.asarray(where)
    if given.size == 0 or (given.ndim == 1 and given.dtype.kind in "iu"):
        chosen = checked_vertices(given.reshape(-1), len(model.mean))
        return model.reference.points[chosen], model.basis.rows(chosen), model.mean[chosen]
    if given.ndim != 2 or given.shape[1] != 3:
        raise InvalidParameter(f"observed points are (m,) vertex indices or (m, 3) positions, not {given.shape}")
    points = as_points(given)
    if model.process is not None:
        return points, model.process.at(points), points + model.process.mean(points)
    corners, weights = carriers(model.reference, points, "surface")
    mean = np.asarray(np.einsum("mc,mcd->md", weights, model.mean[corners]))
    return points, model.basis.rows(corners, weights), mean


def carriers(
    mesh: PolygonMesh, points: Points, interpolation: Interpolation, cells: NDArray[np.int32] | None = None
) -> tuple[NDArray[np.int64], Floats]:
    """(m, c) vertices that each point follows, and their weights, c = 1, 3 or 4.

    Raises
    ------
    InvalidParameter
        An unknown word, or tetrahedra of a model that has none.
    """
    if interpolation not in ("nearest", "surface", "tetrahedra"):
        raise InvalidParameter(
            f"a model interpolates by 'nearest', 'surface' or 'tetrahedra', not by {interpolation!r}"
        )
    if interpolation == "tetrahedra":
        if cells is None or not len(cells):
            raise InvalidParameter("the model has no tetrahedra to interpolate in: take 'surface' or 'nearest'")
        from pliant.shape.tetrahedra import surrounding

        corners, weights = surrounding(mesh.points, cells, points)
        return corners.astype(np.int64), weights
    if interpolation == "surface" and len(mesh.triangles):
        from pliant.numerics.meshes.closest_surface import TriangleSearch

        found = TriangleSearch(mesh.points, mesh.triangles).query(points)
        return mesh.triangles[found.triangles].astype(np.int64), found.weights
    from scipy.spatial import cKDTree

    nearest = cKDTree(mesh.points).query(points)[1] if len(points) else np.empty(0, np.int64)
    return np.asarray(nearest, np.int64)[:, None], np.ones((len(points), 1))


def checked_vertices(vertices: ArrayLike, count: int) -> NDArray[np.int64]:
    """(m,) indices from 0 to below count.

    Raises
    ------
    InvalidParameter
        Others; the first is named.
    """
    given = np.asarray(vertices)
    if given.size == 0:
        return np.empty(0, np.int64)
    if given.ndim != 1 or given.dtype.kind not in "iu":
        raise InvalidParameter(f"vertices are whole numbers (m,), not {given.dtype} of shape {given.shape}")
    bad = np.flatnonzero((given < 0) | (given >= count))
    if len(bad):
        raise InvalidParameter(f"vertex {given[bad[0]]} is not in the model: it has {count:,}, counted from 0")
    return given.astype(np.int64)


def submesh(
    mesh: PolygonMesh, cells: NDArray[np.int32] | None, chosen: NDArray[np.int64]
) -> tuple[PolygonMesh, NDArray[np.int32] | None]:
    """The mesh of some vertices: the faces, lines and tetrahedra all of whose corners are among them."""
    new = np.full(len(mesh.points), -1, np.int32)
    new[chosen] = np.arange(len(chosen))
    lines = None if mesh.lines is None else _kept(mesh.lines, new)
    part = PolygonMesh(mesh.points[chosen], _kept(mesh.faces, new), lines=lines)
    if cells is None:
        return part, None
    moved = new[cells]
    return part, moved[(moved >= 0).all(axis=1)]


def _kept(rows: Ragged, new: NDArray[np.int32]) -> Ragged:
    return Ragged.of([new[row] for row in rows if (new[row] >= 0).all()])
