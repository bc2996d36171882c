"""What the faces of a mesh wear: a colour at each corner of a triangle, or a piece of a picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.io.mesh_formats.colors import as_bytes, is_color
from pliant.mesh import Material, PolygonMesh
from pliant.rendering.palette import CHECKER, CLAY
from pliant.rendering.quantities import Quantity, painted

Image = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Coat:
    """The look of a surface.

    Parameters
    ----------
    colors
        (t, 3, 3) RGB at the corners of ``mesh.triangles``.
    pictures
        Triangles (t,) bool that wear a picture instead, and the picture.
    legible
        Whether the colours mean numbers, so that light must not change them much.
    """

    colors: NDArray[np.uint8]
    pictures: tuple[tuple[NDArray[np.bool_], Image], ...] = ()
    legible: bool = False


def coat_of_numbers(mesh: PolygonMesh, paint: Quantity) -> Coat:
    """A coat that shows a quantity."""
    colors = painted(paint)
    if paint.on_faces:
        return Coat(np.repeat(colors[mesh.triangle_faces][:, None], 3, axis=1), legible=True)
    return Coat(colors[mesh.triangles], legible=True)


def coat_of_its_own(mesh: PolygonMesh, texture: Path | str | None, *, checkered: bool) -> Coat:
    """What the mesh itself says that it wears: textures, materials, the colours of vertices or faces; else clay.

    Parameters
    ----------
    mesh
        The mesh.
    texture
        A picture for all faces, instead of their materials'.
    checkered
        Whether faces with no picture wear a checkerboard.

    Raises
    ------
    InvalidParameter
        A texture is asked for, and the mesh has no texture coordinates.
    UnreadableFile
        A picture cannot be read.
    """
    colors = _stored_colors(mesh)
    if mesh.uvs is None:
        if checkered or texture is not None:
            raise InvalidParameter("the mesh has no texture coordinates, so that it cannot wear a texture")
        return Coat(colors)
    has_place = np.all(mesh.uvs.indices[mesh.triangle_corners] >= 0, axis=1)
    if texture is not None:
        return Coat(colors, ((has_place, _picture(texture)),))
    pictures = [
        (has_place & triangles, _picture(material.texture))
        for triangles, material in _materials(mesh)
        if material.texture is not None
    ]
    if checkered and not pictures:
        pictures = [(has_place, checker())]
    return Coat(colors, tuple(pictures))


def checker(squares: int = 16, pixels: int = 64) -> Image:
    """A checkerboard to wear where there is no texture."""
    odd = np.indices((squares, squares)).sum(axis=0) % 2
    colors = np.asarray(np.rint(255 * np.array(CHECKER)), np.uint8)
    return np.asarray(colors[np.kron(odd, np.ones((pixels, pixels), int))])


def _stored_colors(mesh: PolygonMesh) -> NDArray[np.uint8]:
    """(t, 3, 3) the colours of vertices, else of faces, else of materials, else clay."""
    of_vertices, of_faces = mesh.vertex_attributes.get("colors"), mesh.face_attributes.get("colors")
    if of_vertices is not None and is_color(of_vertices):
        return as_bytes(of_vertices)[:, :3][mesh.triangles]
    if of_faces is not None and is_color(of_faces):
        return np.repeat(as_bytes(of_faces)[:, None, :3][mesh.triangle_faces], 3, axis=1)
    colors = np.tile(as_bytes(np.array(CLAY)), (len(mesh.triangles), 3, 1))
    for triangles, material in _materials(mesh):
        if material.color != Material("").color:  # a material that names none is clay
            colors[triangles] = as_bytes(np.array(material.color))
    return colors


def _materials(mesh: PolygonMesh) -> list[tuple[NDArray[np.bool_], Material]]:
    """Each material of the library with its triangles; a library's only material is everybody's."""
    library = mesh.material_library
    if mesh.materials is None:
        return [(np.ones(len(mesh.triangles), bool), each) for each in library.values()] if len(library) == 1 else []
    of_triangles = mesh.materials.indices[mesh.triangle_faces]
    return [(of_triangles == at, library[name]) for at, name in enumerate(mesh.materials.names) if name in library]


def _picture(path: Path | str) -> Image:
    from PIL import Image as Pictures

    try:
        with Pictures.open(path) as image:
            return np.asarray(image.convert("RGB"))
    except OSError as error:
        raise UnreadableFile(path, f"no texture can be read from it: {error}", "name a PNG or JPEG image") from error
