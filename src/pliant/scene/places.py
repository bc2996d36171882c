"""Files that a mesh refers to, as places in the folder of its project: never elsewhere on the disk."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path, PurePosixPath

from pliant.attributes import Material
from pliant.errors import InvalidParameter, PliantWarning
from pliant.mesh import PolygonMesh


def inside(path: Path, folder: Path) -> str:
    """A path as a place in a folder or below it, as :func:`stored_place` allows.

    Raises
    ------
    InvalidParameter
        It is elsewhere.
    """
    try:
        return stored_place(path.resolve().relative_to(folder.resolve()).as_posix())
    except ValueError:
        raise InvalidParameter(
            f"{path} does not lie in the project's folder {folder}: a project refers to nothing outside it"
        ) from None


def stored_place(text: str) -> str:
    """A place as it stands in a project: relative, with forward slashes, never upwards.

    Raises
    ------
    InvalidParameter
        Anything else.
    """
    place = PurePosixPath(text.replace("\\", "/"))
    if place.is_absolute() or ".." in place.parts or ":" in text or "\0" in text or not place.parts:
        raise InvalidParameter(f"{text!r} is no place in the project's folder: a project refers to nothing outside it")
    return place.as_posix()


def portable(mesh: PolygonMesh, folder: Path) -> PolygonMesh:
    """A mesh to be stored: without its source and its reader's notes, textures as places in the project's folder.

    Warns
    -----
    PliantWarning
        A texture lies outside the folder; it is left out.
    """
    library = {name: _kept(material, folder) for name, material in mesh.material_library.items()}
    return mesh.replace(source=None, carrier=None, material_library=library)


def located(mesh: PolygonMesh, folder: Path) -> PolygonMesh:
    """A mesh that was stored: textures as paths again.

    Raises
    ------
    InvalidParameter
        A texture that is not in the project's folder.
    """
    library = {
        name: material
        if material.texture is None
        else replace(material, texture=folder / stored_place(material.texture.as_posix()))
        for name, material in mesh.material_library.items()
    }
    return mesh.replace(source=None, material_library=library)


def _kept(material: Material, folder: Path) -> Material:
    if material.texture is None:
        return material
    try:
        return replace(material, texture=Path(inside(material.texture, folder)))
    except InvalidParameter as error:
        warnings.warn(f"the texture of {material.name!r} is left out: {error}", PliantWarning, stacklevel=4)
        return replace(material, texture=None)
