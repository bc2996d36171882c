"""Deformation transfer: what one shape does, another does too."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, kron

from pliant.errors import InvalidParameter, InvalidTarget
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.meshes.adjacency import unique_edges
from pliant.numerics.meshes.gradients import DeformationGradients, plane_gradients, sound
from pliant.numerics.meshes.graphs import components, edge_graph
from pliant.numerics.ragged import Ragged, frozen
from pliant.numerics.sparse.sparse_cholesky import Cholesky
from pliant.surface.constraints import mesh_of
from pliant.surface.correspondence import Progress, checked_markers, find_correspondence
from pliant.surface.shading import shading_normals

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_FLAT = 1e-6  # of the mean weight: how strongly the sides of a triangle without area hold together


class DeformationTransfer:
    """Puts a target mesh into the poses of a source mesh of another connectivity (Sumner & Popović 2004).

    Each triangle of the target is given the deformation gradient of the source triangles that belong to it; the
    vertices are those whose gradients come nearest, weighted by area (Botsch et al. 2006). The matrix is factored once:
    a pose costs one back-substitution. Both meshes stand in the same pose and orientation at rest.

    Parameters
    ----------
    source, target
        The meshes at rest.
    markers
        (k, 2) pairs of vertices, source and target, that correspond.
    correspondence
        (c, 2) pairs of triangles found earlier, :attr:`correspondence` of another transfer between the same meshes;
        None = find them.
    progress
        While they are found: called with the number of steps done, and of all. What it raises ends the work.

    Raises
    ------
    InvalidParameter
        Markers or pairs that the meshes do not have.
    InvalidTarget, InvalidMesh
        Bare points, or a mesh without triangles.
    """

    def __init__(
        self,
        source: PolygonMesh,
        target: PolygonMesh,
        markers: ArrayLike,
        *,
        correspondence: ArrayLike | None = None,
        progress: Progress | None = None,
    ) -> None:
        self.source, self.target = mesh_of(source, "transfer"), mesh_of(target, "transfer")
        self.markers = frozen(checked_markers(markers, source, target), np.int64)
        pairs = (
            find_correspondence(source, target, self.markers, progress)
            if correspondence is None
            else _checked_pairs(correspondence, source, target)
        )
        self.correspondence: Integers = frozen(pairs, np.int64)
        self._prepare()

    def _prepare(self) -> None:
        points, triangles = self.target.points, self.target.triangles
        count = len(triangles)
        one, two = (points[triangles[:, i]] - points[triangles[:, 0]] for i in (1, 2))
        area = np.linalg.norm(np.cross(one, two), axis=1) / 2
        gradients = plane_gradients(points, triangles)
        divergence = csr_array(gradients.T @ diags_array(np.repeat(area, 3)))
        self._gradients = DeformationGradients(self.source.points, self.source.triangles)
        pull = np.bincount(self.correspondence[:, 1], minlength=count)
        self._averaging = csr_array(
            (1 / pull[self.correspondence[:, 1]], (self.correspondence[:, 1], self.correspondence[:, 0])),
            shape=(count, len(self.source.triangles)),
        )
        edges = unique_edges(Ragged.of(triangles))
        self._label = components(edge_graph(points, edges))
        self._divergence = csr_array(divergence @ kron(self._averaging, eye_array(3), format="csr"))
        loose = _difference(len(points), edges, triangles[~sound(points, triangles)])
        stiffness = csr_array(divergence @ gradients)
        weak = _FLAT * float(stiffness.diagonal().mean() or 1.0)
        stiffness = csr_array(stiffness + weak * (loose.T @ loose))
        diagonal = stiffness.diagonal()
        first = np.unique(self._label, return_index=True)[1]
        pin = np.zeros(len(points))
        pin[first] = float(diagonal.mean()) or 1.0  # one vertex a component: gradients do not say where it is
        self._factor = Cholesky(csc_array(stiffness + diags_array(pin)))

    def points(self, pose: PolygonMesh | ArrayLike) -> Points:
        """(n, 3) the target's points in a pose of the source, as :meth:`__call__`.

        Parameters
        ----------
        pose
            The source with its vertices elsewhere, or (m, 3) their positions.

        Raises
        ------
        InvalidTarget
            Another number of points than the source's.
        """
        posed = as_points(pose, borrow=True)
        if posed.shape != self.source.points.shape:
            raise InvalidTarget(
                f"the pose has {len(posed):,} points; the source has {len(self.source.points):,}: a pose is the source "
                "mesh with its vertices elsewhere"
            )
        rest = self.target.points
        change = self._gradients(posed) - np.eye(3)  # displacements: the pose at rest is exact
        wanted = self._divergence @ change.transpose(0, 2, 1).reshape(-1, 3)
        displacement = self._factor.solve(np.asarray(wanted))
        return np.asarray(rest + displacement + self._shifts(posed, displacement)[self._label])

    def __call__(self, pose: PolygonMesh | ArrayLike) -> PolygonMesh:
        """The target in a pose.

        Parameters
        ----------
        pose
            The source mesh with its vertices elsewhere, or its (n, 3) points. Each component of the target goes along
            with the source triangles that belong to it, in proportion to the sizes of the two meshes.

        Raises
        ------
        InvalidTarget
            The pose has another number of points than the source.
        """
        points = self.points(pose)
        return self.target.with_points(points, normals=shading_normals(self.target, points))

    def _shifts(self, posed: Points, displacement: Points) -> Points:
        """(components, 3) what to add to each component's displacements."""
        source, target = self.source, self.target
        scale = (target.diagonal or 1.0) / (source.diagonal or 1.0)
        moved = scale * (posed - source.points)[source.triangles].mean(axis=1)
        wanted = np.asarray(self._averaging @ moved) - displacement[target.triangles].mean(axis=1)
        owner = self._label[target.triangles[:, 0]]
        size = int(self._label.max()) + 1
        count = np.maximum(np.bincount(owner, minlength=size), 1)
        return (
            np.stack([np.bincount(owner, weights=column, minlength=size) for column in wanted.T], axis=1)
            / count[:, None]
        )


def _difference(count: int, edges: NDArray[np.int32], flat: NDArray[np.int32]) -> csr_array:
    """Differences along the sides of triangles without area, one a row."""
    sides = unique_edges(Ragged.of(flat)) if len(flat) else edges[:0]
    rows = np.tile(np.arange(len(sides)), 2)
    values: Any = np.repeat([1.0, -1.0], len(sides))
    return csr_array((values, (rows, sides.T.reshape(-1))), shape=(len(sides), count))


def _checked_pairs(pairs: ArrayLike, source: PolygonMesh, target: PolygonMesh) -> Integers:
    array = np.asarray(pairs)
    if array.ndim != 2 or array.shape[1] != 2 or not np.issubdtype(array.dtype, np.integer):
        raise InvalidParameter(f"a correspondence is (c, 2) pairs of triangles; given: {array.shape} of {array.dtype}")
    for column, (name, mesh) in enumerate((("source", source), ("target", target))):
        if array.size and not 0 <= array[:, column].min() <= array[:, column].max() < len(mesh.triangles):
            raise InvalidParameter(
                f"the correspondence uses {name} triangle {array[:, column].max()}; the {name} has "
                f"{len(mesh.triangles):,}: it belongs to other meshes"
            )
    missing = np.setdiff1d(np.arange(len(target.triangles)), array[:, 1])
    if len(missing):
        raise InvalidParameter(f"the correspondence leaves {len(missing):,} target triangles out, first {missing[0]}")
    return array.astype(np.int64)
