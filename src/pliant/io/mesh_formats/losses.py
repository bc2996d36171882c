"""What a mesh loses in a format: told from the format's own table, one sentence a loss."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnsupportedFormat
from pliant.io.mesh_formats.carrier import Carrier
from pliant.io.mesh_formats.colors import as_bytes, as_float, is_color
from pliant.io.mesh_formats.format import Keeps
from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.compute.chunks import for_chunks


def losses_of(
    mesh: PolygonMesh, keeps: Keeps, *, known_faces: tuple[str, ...] = (), known_vertices: tuple[str, ...] = ()
) -> tuple[str, ...]:
    """What a new file of a format cannot hold of a mesh.

    Parameters
    ----------
    mesh
        The mesh.
    keeps
        The format's table.
    known_faces, known_vertices
        Attributes that the format has a place for though it has none for attributes at large.
    """
    return (
        *_shape(mesh, keeps),
        *_corners(mesh, keeps),
        *_names(mesh, keeps),
        *_attributes(mesh, keeps, known_faces, known_vertices),
        *(mesh.carrier.unique if isinstance(mesh.carrier, Carrier) else ()),
    )


def _shape(mesh: PolygonMesh, keeps: Keeps) -> Iterator[str]:
    sides = mesh.faces.lengths
    if not keeps.faces:
        if len(sides):
            yield f"{len(sides):,} faces: points alone are kept"
    elif not keeps.polygons:
        if count := int((sides > 3).sum()):
            yield f"{count:,} polygons are cut into {int((sides[sides > 3] - 2).sum()):,} triangles"
        if count := int((sides < 3).sum()):
            yield f"{count:,} faces of fewer than three corners"
    if not keeps.cells:
        yield from (f"{len(rows):,} cells of the kind {kind!r}" for kind, rows in mesh.cells.items())
    flat = mesh.faces.flat
    if not keeps.shared_vertices and not (len(flat) == len(mesh.points) and (flat == np.arange(len(flat))).all()):
        used = np.zeros(len(mesh.points), bool)
        used[flat] = True
        unused = len(used) - int(used.sum())
        yield "triangles no longer share vertices" + (f"; {unused:,} unused vertices" if unused else "")
    if mesh.lines is not None and not keeps.lines:
        yield f"{len(mesh.lines):,} lines"


def per_vertex(mesh: PolygonMesh, corner: CornerValues | None) -> bool:
    """Whether corner values are one a vertex, in the vertices' order."""
    if corner is None or len(corner.values) != len(mesh.points):
        return False
    return corner.indices is mesh.faces.flat or np.array_equal(corner.indices, mesh.faces.flat)


def _corners(mesh: PolygonMesh, keeps: Keeps) -> Iterator[str]:
    if mesh.uvs is not None and not keeps.corner_uvs:
        yield f"{len(mesh.uvs.values):,} texture coordinates"
    stored = "normals" in mesh.vertex_attributes
    if mesh.normals is not None and not keeps.corner_normals:
        simple = keeps.vertex_normals and not stored and per_vertex(mesh, mesh.normals)
        if not simple:
            yield f"{len(mesh.normals.values):,} normals at the corners of faces"
    if stored and not keeps.vertex_normals:
        yield f"{len(mesh.points):,} normals at vertices"
    elif stored and mesh.normals is not None and keeps.corner_normals:
        yield f"{len(mesh.points):,} normals at vertices: those at the corners of faces are kept"


def _names(mesh: PolygonMesh, keeps: Keeps) -> Iterator[str]:
    for name in ("groups", "objects", "materials"):
        labels = getattr(mesh, name)
        if labels is not None and not getattr(keeps, name):
            yield f"the names of {len(labels.names):,} {name}"
    if mesh.material_library and not keeps.materials:
        yield f"the definitions of {len(mesh.material_library):,} materials"
    textures = {each.texture for each in mesh.material_library.values() if each.texture is not None}
    if textures and not keeps.textures:
        yield f"{len(textures):,} textures"


def _attributes(
    mesh: PolygonMesh, keeps: Keeps, known_faces: tuple[str, ...], known_vertices: tuple[str, ...]
) -> Iterator[str]:
    colored = {"vertex": keeps.vertex_colors, "face": keeps.face_colors}
    held = {"vertex": keeps.vertex_attributes, "face": keeps.face_attributes}
    known = {"vertex": (*known_vertices, "normals"), "face": known_faces}
    for kind, attributes in (("vertex", mesh.vertex_attributes), ("face", mesh.face_attributes)):
        for name, values in attributes.items():
            place = colored[kind] if name == "colors" and is_color(values) else held[kind]
            if not place and name not in known[kind]:
                yield f"the {kind} attribute {name!r}"


def color_rounding(colors: NDArray[Any]) -> tuple[str, ...]:
    """The loss, if any, of colours that become bytes."""
    error = np.abs(as_bytes(colors) / 255 - as_float(colors)).max(initial=0.0)
    return (f"colours are rounded to 8 bits: by up to {error:.2g}",) if error > 1e-12 else ()


def as_float32(points: NDArray[np.float64], name: str) -> tuple[NDArray[np.float32], tuple[str, ...]]:
    """Coordinates in single precision, and what that rounds away as a sentence, if anything.

    Raises
    ------
    UnsupportedFormat
        Coordinates beyond the range of single precision.
    """
    rounded = np.empty(points.shape, np.float32)
    errors = [0.0]

    def work(first: int, stop: int) -> None:
        with np.errstate(over="ignore"):
            rounded[first:stop] = points[first:stop]
        errors.append(float(np.abs(rounded[first:stop] - points[first:stop]).max()))

    for_chunks(work, len(points))
    error = max(errors)
    if not np.isfinite(error):
        raise UnsupportedFormat(
            f"{name} stores coordinates in 32 bits, which end at 3.4e38; the largest here is "
            f"{np.abs(points).max():.3g}: scale the mesh"
        )
    return rounded, (f"coordinates are rounded to 32 bits: by up to {error:.2g}",) if error > 0 else ()
