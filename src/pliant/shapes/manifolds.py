"""Meshes as manifold3d's solids and back; groups of faces are kept."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.attributes import FaceLabels
from pliant.errors import InvalidMesh, MissingExtra
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged

Names = dict[int, str]


def manifold_of(mesh: PolygonMesh, names: Names) -> Any:
    """A closed mesh as a solid; what its groups are called is added to ``names`` by their numbers in the solid.

    Raises
    ------
    InvalidMesh
        The mesh is not closed, or not consistently oriented.
    MissingExtra
        manifold3d is not installed.
    """
    library = import_manifold()
    labels = mesh.groups or FaceLabels(("solid",), np.zeros(len(mesh.faces), np.int32))
    of_triangle = np.asarray(labels.indices)[mesh.triangle_faces]
    order = np.argsort(of_triangle, kind="stable")
    triangles = mesh.triangles[order].astype(np.uint64)
    groups, starts = np.unique(of_triangle[order], return_index=True)
    first = library.Manifold.reserve_ids(max(1, len(groups)))
    names.update({first + i: labels.names[group] for i, group in enumerate(groups) if group >= 0})
    solid = library.Manifold(
        library.Mesh64(
            mesh.points.copy(),
            triangles,
            run_index=np.append(3 * starts, 3 * len(triangles)).astype(np.uint64),
            run_original_id=np.arange(first, first + len(groups), dtype=np.uint32),
        )
    )
    if solid.status() != library.Error.NoError:
        open_edges, crowded = mesh.edge_use
        raise InvalidMesh(
            f"no solid: {open_edges} edges bound one face only, {crowded} bound three or more or disagree "
            f"({solid.status().name}; close the mesh and turn all faces outwards)"
        )
    return solid


def mesh_of(solid: Any, names: Names) -> PolygonMesh:
    """A solid as a mesh of triangles in the groups that they came from."""
    found = solid.to_mesh64()
    ids, ends = np.asarray(found.run_original_id), np.asarray(found.run_index) // 3
    words = tuple(dict.fromkeys(names.get(int(each), "solid") for each in ids)) or ("solid",)
    numbers = [words.index(names.get(int(each), "solid")) for each in ids]
    labels = np.repeat(np.array(numbers, np.int32), np.diff(ends).astype(np.int64))
    faces = np.asarray(found.tri_verts, np.int32).reshape(-1, 3)
    return PolygonMesh(np.asarray(found.vert_properties)[:, :3], Ragged.of(faces), groups=FaceLabels(words, labels))


def import_manifold() -> Any:
    """manifold3d."""
    try:
        import manifold3d
    except ImportError:
        raise MissingExtra("constructive modelling", "shapes") from None
    return manifold3d
