"""Contour-mean skeletons: a shape's low frequencies, averaged over the loops of its isolines."""

from __future__ import annotations

import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_count
from pliant.numerics.meshes.adjacency import unique_edges
from pliant.numerics.meshes.eigenpairs import lowest_eigenpairs
from pliant.numerics.meshes.graphs import components, edge_graph, nearest_source
from pliant.numerics.meshes.laplacians import cotangent_weights, laplacian, masses
from pliant.numerics.ragged import Ragged
from pliant.surface.constraints import mesh_of
from pliant.surface.isolines import isolines

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_SMALLEST = 8  # vertices: a component with fewer is one group

_known: weakref.WeakKeyDictionary[PolygonMesh, dict[tuple[int, str | None, int], ContourSkeleton]]
_known = weakref.WeakKeyDictionary()  # meshes never change


@dataclass(frozen=True, eq=False)
class ContourSkeleton:
    """A skeleton of points, each standing for a group of vertices.

    Parameters
    ----------
    points
        (g, 3) one point a group.
    groups
        (n,) the group of each vertex; -1 for a vertex that no face uses.
    links
        (l, 2) groups that follow each other.
    scalar
        (n,) what the isolines were drawn of.
    """

    points: Points
    groups: Integers
    links: Integers
    scalar: Floats

    @property
    def carried(self) -> Points:
        """(n, 3) the skeleton's point that each vertex belongs to; zero for a vertex without a group."""
        padded = np.vstack([self.points, np.zeros((1, 3))])
        return padded[self.groups]

    def following(self, displacements: ArrayLike) -> Points:
        """(g, 3) the skeleton's points when each goes along with its group: by the mean of its (n, 3) displacements.

        Parameters
        ----------
        displacements
            (n, 3) of the mesh's vertices.
        """
        moved, used = np.asarray(displacements, np.float64), self.groups >= 0
        groups, size = self.groups[used], len(self.points)
        count = np.maximum(np.bincount(groups, minlength=size), 1)
        sums = [np.bincount(groups, weights=column, minlength=size) for column in moved[used].T]
        return np.asarray(self.points + np.stack(sums, axis=1) / count[:, None])

    def as_mesh(self) -> PolygonMesh:
        """The links as polylines, to be written or drawn."""
        return PolygonMesh(self.points, lines=Ragged.of(self.links.astype(np.int32)))


def contour_skeleton(
    mesh: PolygonMesh, contours: int = 30, scalar: ArrayLike | str | None = None, *, eigenvectors: int = 10
) -> ContourSkeleton:
    """The contour-mean skeleton of a mesh.

    The first eigenvectors of the cotangent Laplacian, W u = λ D u with D the mass matrix, reconstruct the shape without
    its details, V = U U^T D X. Isolines of a scalar cut it; each closed loop, in each component, gathers the vertices
    of the edges that it crosses, and those that are nearer to them along the surface than to any other loop's. The mean
    of V over such a group is the skeleton's point.

    Parameters
    ----------
    mesh
        The mesh; its components are treated one by one.
    contours
        Levels of the scalar, evenly between its least and greatest value in the component.
    scalar
        (n,) what to draw the isolines of; ``"x"``, ``"y"`` or ``"z"``; None = the first eigenvector that is not
        constant, which runs along a shape.
    eigenvectors
        How many reconstruct the shape, the constant one included: 6 to 15 keep its pose, 3 lose it.

    Raises
    ------
    InvalidMesh
        The mesh has no triangle.
    InvalidTarget
        Bare points.
    InvalidParameter
        Less than one contour or two eigenvectors, or a scalar that is not one finite number a vertex.
    """
    mesh = mesh_of(mesh, "a contour skeleton")
    as_count("contours", contours, InvalidParameter, 1)
    as_count("eigenvectors", eigenvectors, InvalidParameter, 2)
    given = None if scalar is None else _scalar_of(mesh, scalar)
    groups, field = np.full(len(mesh.points), -1, np.int64), np.zeros(len(mesh.points))
    points, links, count = [], [], 0
    label = components(edge_graph(mesh.points, unique_edges(Ragged.of(mesh.triangles))))
    for name in np.unique(label[mesh.triangles]):
        member = np.flatnonzero(label == name)
        place = np.full(len(mesh.points), -1)
        place[member] = np.arange(len(member))
        piece = _Piece(mesh.points[member], place[mesh.triangles[label[mesh.triangles[:, 0]] == name]].astype(np.int32))
        part = piece.skeleton(contours, None if given is None else given[member], eigenvectors)
        groups[member], field[member] = part.groups + count, part.scalar
        points.append(part.points)
        links.append(part.links + count)
        count += len(part.points)
    return ContourSkeleton(np.vstack(points), groups, np.vstack(links), field)


def known_skeleton(
    mesh: PolygonMesh, contours: int, scalar: ArrayLike | str | None, eigenvectors: int
) -> ContourSkeleton:
    """The contour skeleton of a mesh, computed once as long as the mesh is there; only to be looked at."""
    if scalar is not None and not isinstance(scalar, str):
        return contour_skeleton(mesh, contours, scalar, eigenvectors=eigenvectors)
    kept = _known.setdefault(mesh, {})
    asked = (contours, scalar, eigenvectors)
    if asked not in kept:
        kept[asked] = contour_skeleton(mesh, contours, scalar, eigenvectors=eigenvectors)
    return kept[asked]


def _scalar_of(mesh: PolygonMesh, scalar: ArrayLike | str) -> Floats:
    if isinstance(scalar, str):
        if scalar not in ("x", "y", "z"):
            raise InvalidParameter(f"no scalar is called {scalar!r}; there are x, y and z, or give one number a vertex")
        return mesh.points[:, "xyz".index(scalar)]
    values = np.asarray(scalar, np.float64)
    if values.shape != mesh.points.shape[:1] or not np.isfinite(values).all():
        raise InvalidParameter(f"the scalar has shape {values.shape}; {len(mesh.points):,} finite numbers are needed")
    return values


@dataclass(frozen=True, eq=False)
class _Piece:
    """One component: (n, 3) points, all of them used, and (t, 3) triangles."""

    points: Points
    triangles: NDArray[np.int32]

    def skeleton(self, contours: int, scalar: Floats | None, eigenvectors: int) -> ContourSkeleton:
        if len(self.points) < _SMALLEST:
            return self._one_group(scalar)
        weights, mass = cotangent_weights(self.points, self.triangles), masses(self.points, self.triangles)
        _, basis = lowest_eigenpairs(laplacian(weights), mass, min(eigenvectors, len(mass) // 2))
        field = basis[:, 1] if scalar is None else scalar
        span = float(np.ptp(field))
        if not span > 1e-12 * max(1.0, float(np.abs(field).max())):
            return self._one_group(field)
        levels = field.min() + span * np.arange(1, contours + 1) / (contours + 1)
        lines = isolines(self.triangles, field, levels)
        edges = unique_edges(Ragged.of(self.triangles))
        seeds, loop = _first_claims(
            lines.edges, lines.loops, np.abs(field[lines.edges] - levels[lines.level][lines.loops, None])
        )
        _, nearest = nearest_source(edge_graph(self.points, edges), seeds)
        owner = np.full(len(field), -1)
        owner[seeds] = loop
        used, groups = np.unique(owner[nearest], return_inverse=True)
        groups = groups.reshape(-1).astype(np.int64)
        smooth = basis @ (basis.T @ (mass[:, None] * self.points))
        sums = np.stack([np.bincount(groups, weights=mass * smooth[:, i]) for i in range(3)], axis=1)
        points = sums / np.bincount(groups, weights=mass)[:, None]
        return ContourSkeleton(points, groups, _links(groups, edges, lines.level[used]), field)

    def _one_group(self, scalar: Floats | None) -> ContourSkeleton:
        groups = np.zeros(len(self.points), np.int64)
        field = np.zeros(len(self.points)) if scalar is None else scalar
        return ContourSkeleton(self.points.mean(axis=0)[None], groups, np.empty((0, 2), np.int64), field)


def _first_claims(edges: NDArray[np.int32], loops: Integers, away: Floats) -> tuple[Integers, Integers]:
    """The vertices of crossed edges, and the loop that comes nearest to each: ``away`` (k, 2) tells how near."""
    vertices, loop = edges.reshape(-1), np.repeat(loops, 2)
    order = np.lexsort((loop, away.reshape(-1), vertices))
    seeds, first = np.unique(vertices[order], return_index=True)
    return seeds.astype(np.int64), loop[order][first]


def _links(groups: Integers, edges: NDArray[np.int32], level: Integers) -> Integers:
    """Neighbouring groups of consecutive levels; others only where the skeleton would fall apart."""
    pairs = np.sort(groups[edges], axis=1)
    pairs, shared = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0, return_counts=True)
    if not len(pairs):
        return np.empty((0, 2), np.int64)
    apart = np.abs(np.diff(level[pairs], axis=1)[:, 0])
    regular = apart == 1
    chosen = list(np.flatnonzero(regular))
    size = len(level)
    for at in np.lexsort((-shared, apart)):
        if not regular[at]:
            graph = csr_array((np.ones(len(chosen)), tuple(pairs[chosen].T)), shape=(size, size))
            label = components(graph)
            if label.max() == 0:
                break
            if label[pairs[at, 0]] != label[pairs[at, 1]]:
                chosen.append(at)
    return pairs[np.sort(chosen)].astype(np.int64)
