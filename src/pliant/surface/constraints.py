"""Which vertices an edit moves freely, which it is told, and which stay: checked before anything is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.errors import InvalidDeformer, InvalidMesh, InvalidTarget
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.graphs import components, grown
from pliant.numerics.ragged import frozen

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Constraints:
    """A mesh's vertices by what an edit does with them.

    Parameters
    ----------
    free
        Ascending; those that are solved for.
    handle
        Those whose positions are the controls, in the user's order.
    belt
        Ascending; those that stay, and share an edge with one that does not.
    """

    free: Integers
    handle: Integers
    belt: Integers


def vertex_set(given: ArrayLike, name: str) -> NDArray[np.int64] | NDArray[np.bool_]:
    """Vertex indices, or a mask over all vertices, as a frozen array.

    Raises
    ------
    InvalidDeformer
        Neither indices nor a mask, negative, or a vertex that is named twice.
    """
    array = np.asarray(given)
    if array.size == 0 and array.dtype != bool:
        array = array.astype(np.int64)
    if array.ndim != 1 or not (array.dtype == bool or np.issubdtype(array.dtype, np.integer)):
        raise InvalidDeformer(
            f"{name} holds vertex indices, or one truth value a vertex; given: {array.dtype} {array.shape}"
        )
    if array.dtype == bool:
        return frozen(array, np.bool_)
    if array.size and array.min() < 0:
        raise InvalidDeformer(f"{name} holds vertex {array.min()}: indices count from 0")
    values, counts = np.unique(array, return_counts=True)
    if (counts > 1).any():
        raise InvalidDeformer(f"{name} names vertex {values[counts > 1][0]} twice: name each once")
    return frozen(array, np.int64)


def mesh_of(target: object, kind: str) -> PolygonMesh:
    """The target, if it is a mesh with triangles.

    Raises
    ------
    InvalidTarget
        Bare points.
    InvalidMesh
        A mesh without a triangle.
    """
    if not isinstance(target, PolygonMesh):
        raise InvalidTarget(f"{kind} needs a mesh: bare points do not say which of them belong together")
    if not len(target.triangles):
        raise InvalidMesh(f"{kind} needs faces: this mesh of {len(target.points):,} points has no triangle")
    return target


def indices_in(mesh: PolygonMesh, chosen: NDArray[np.int64] | NDArray[np.bool_], name: str) -> Integers:
    """A set of vertices as indices into a mesh, in the order given.

    Raises
    ------
    InvalidTarget
        The mesh has no such vertex, or a mask has another length.
    """
    count = len(mesh.points)
    if chosen.dtype == bool:
        if len(chosen) != count:
            raise InvalidTarget(f"{name} is a mask of {len(chosen):,} vertices; the mesh has {count:,}")
        return np.flatnonzero(chosen)
    if chosen.size and chosen.max() >= count:
        raise InvalidTarget(f"{name} holds vertex {chosen.max()}; the mesh has {count:,}, counted from 0")
    return chosen.astype(np.int64)


def constrain(
    mesh: PolygonMesh,
    roi: NDArray[np.int64] | NDArray[np.bool_],
    handle: NDArray[np.int64] | NDArray[np.bool_],
    graph: csr_array,
) -> Constraints:
    """Sort a mesh's vertices, and make sure that everything free is tied to something.

    A vertex of the region that no edge reaches is left where it is.

    Parameters
    ----------
    mesh
        The mesh.
    roi, handle
        From :func:`vertex_set`; the handle lies inside the region.
    graph
        (n, n) sparse, symmetric: which vertices influence each other.

    Raises
    ------
    InvalidDeformer
        No handle, a handle outside the region, or a component of the mesh that lies in the region and holds no
        handle.
    InvalidTarget
        Vertices that the mesh does not have.
    """
    region, held = indices_in(mesh, roi, "roi"), indices_in(mesh, handle, "handle")
    if not len(held):
        raise InvalidDeformer("the handle is empty: name at least one vertex to move")
    inside = np.zeros(len(mesh.points), bool)
    inside[region] = True
    if not inside[held].all():
        outside = held[~inside[held]]
        raise InvalidDeformer(
            f"{len(outside)} of the handle's {len(held)} vertices lie outside the region of interest, the first is "
            f"vertex {outside[0]}: add them to roi"
        )
    movable = inside.copy()
    movable[held] = False
    movable &= np.diff(graph.indptr) > 0
    _require_ties(graph, movable)
    moving = movable.copy()
    moving[held] = True
    belt = grown(graph, moving, 1) & ~moving
    return Constraints(np.flatnonzero(movable), held, np.flatnonzero(belt))


def _require_ties(graph: csr_array, movable: NDArray[np.bool_]) -> None:
    label = components(graph)
    tied = np.zeros(int(label.max(initial=-1)) + 1, bool)
    tied[label[~movable]] = True
    loose = np.flatnonzero(~tied[label[movable]])
    if not len(loose):
        return
    vertex = int(np.flatnonzero(movable)[loose[0]])
    size, count = int((label == label[vertex]).sum()), int((~tied).sum())
    raise InvalidDeformer(
        f"the component of vertex {vertex} ({size:,} vertices) lies wholly inside the region of interest and holds no "
        f"handle, so that nothing ties it down ({count} such component{'s' if count > 1 else ''}): put a handle on it, "
        "or leave it out of roi"
    )
