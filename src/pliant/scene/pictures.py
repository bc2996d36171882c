"""Pictures that travel in a project: textures that lie outside of its folder, which it cannot refer to."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, PliantError
from pliant.io.files import read_bytes, write_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.places import inside
from pliant.scene.values import Arrays

MOST_BYTES = 64 << 20  # of one picture
_ENDINGS = (".png", ".jpg", ".jpeg", ".webp", ".bmp", ".gif", ".tga", ".tif", ".tiff")


def packed(mesh: PolygonMesh, folder: Path, arrays: Arrays) -> tuple[PolygonMesh, dict[str, Any]]:
    """A mesh without the textures that lie outside of a folder, and what to keep of these; their bytes go to arrays.

    What cannot be read, or is no picture of 64 MB at most, stays as it is.
    """
    library = dict(mesh.material_library)
    kept: dict[str, Any] = {}
    for name, material in mesh.material_library.items():
        data = None if material.texture is None else _outside(material.texture, folder)
        if data is not None and material.texture is not None:
            array = f"pictures/{len(kept)}"
            arrays[array] = np.frombuffer(data, np.uint8)
            kept[name] = {"ending": material.texture.suffix.lower(), "array": array}
            library[name] = replace(material, texture=None)
    return mesh.replace(material_library=library) if kept else mesh, kept


def unpacked(mesh: PolygonMesh, kept: Any, arrays: Mapping[str, NDArray[Any]]) -> PolygonMesh:
    """A mesh with the pictures that were packed, as files of a folder that goes when the program ends.

    Raises
    ------
    InvalidParameter
        They are no pictures, or of materials that the mesh has not.
    """
    if not kept:
        return mesh
    if not isinstance(kept, dict):
        raise InvalidParameter("its pictures are no names and files")
    library = dict(mesh.material_library)
    for name, entry in kept.items():
        ending, array = (entry.get("ending"), entry.get("array")) if isinstance(entry, dict) else (None, None)
        data = arrays.get(array) if isinstance(array, str) else None
        if name not in library or ending not in _ENDINGS or data is None or data.dtype != np.uint8:
            raise InvalidParameter(f"the picture of the material {name!r} is none")
        content = data.tobytes()
        path = Path(pictures_folder()) / f"{blake2b(content, digest_size=12).hexdigest()}{ending}"
        if not path.is_file():
            write_bytes(path, content)
        library[name] = replace(library[name], texture=path)
    return mesh.replace(material_library=library)


def pictures_folder() -> Path:
    """Where pictures of projects are, as long as the program runs."""
    return Path(_folder().name)


def _outside(texture: Path, folder: Path) -> bytes | None:
    """The bytes of a picture that is not in a folder; None where it is, or where there are none."""
    if texture.suffix.lower() not in _ENDINGS:
        return None
    try:
        inside(texture, folder)
    except InvalidParameter:
        try:
            data = read_bytes(texture)
        except PliantError:
            return None
        return data if len(data) <= MOST_BYTES else None
    return None


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="pliant-pictures-")
