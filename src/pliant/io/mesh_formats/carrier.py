"""What a reader keeps so that the very same file can be written with other positions.

A carrier holds the file's bytes, the mesh as it was read, and where in the bytes its numbers stand. A mesh takes its
carrier along as long as only positions and stored normals change; the fields are compared when it is written, so
that a carrier never speaks for a mesh that has become another.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged

_FIELDS = ("faces", "uvs", "groups", "objects", "materials", "material_library", "face_attributes", "lines", "cells")


@dataclass(frozen=True, eq=False)
class Carrier:
    """The file behind a mesh.

    Parameters
    ----------
    format
        The name of the format that reads it.
    data
        Its bytes.
    mesh
        The mesh as it was read.
    layout
        Where the numbers stand; the format's own.
    unique
        What only the file holds, as sentences: lost when it is written in any other way.
    """

    format: str
    data: bytes
    mesh: PolygonMesh
    layout: Any
    unique: tuple[str, ...] = ()


def with_carrier(mesh: PolygonMesh, name: str, data: bytes, layout: Any, unique: tuple[str, ...] = ()) -> PolygonMesh:
    """The mesh as read, with its carrier."""
    return mesh.replace(carrier=Carrier(name, data, mesh, layout, unique))


def carrier_of(mesh: PolygonMesh, name: str) -> Carrier | None:
    """The mesh's carrier, if it is of the named format and only positions and normals have changed since."""
    carrier = mesh.carrier
    if not isinstance(carrier, Carrier) or carrier.format != name:
        return None
    old = carrier.mesh
    same = len(old.points) == len(mesh.points) and all(_same(getattr(old, f), getattr(mesh, f)) for f in _FIELDS)
    before, now = dict(old.vertex_attributes), dict(mesh.vertex_attributes)
    same = same and ("normals" in before) == ("normals" in now) and (old.normals is None) == (mesh.normals is None)
    before.pop("normals", None), now.pop("normals", None)
    return carrier if same and _same(before, now) else None


def _same(a: Any, b: Any) -> bool:
    """Equal in content; a glance where they are the same object, as after a deformation."""
    if a is b:
        return True
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return list(a) == list(b) and all(_same(a[name], b[name]) for name in a)
    if type(a) is type(b) and (isinstance(a, Ragged) or hasattr(a, "__dataclass_fields__")):
        return all(_same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return bool(a == b)
