"""What a page fetches of a mesh when it needs it: edges, the shape at rest, textures."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidParameter
from pliant.io.files import read_bytes
from pliant.studio.request import Request, command
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_MOST_TEXTURE = 64 << 20


@command("mesh.edges", reads=True)
def edges(session: Session, request: Request) -> Frame:
    """Edges of the polygons."""
    return Frame({}, {"edges": session.shown.drawn.edges})


@command("mesh.rest", reads=True)
def rest(session: Session, request: Request) -> Frame:
    """Positions and normals before the deformation."""
    drawn, points = session.shown.drawn, session.required.mesh.points
    return Frame({}, {"positions": points.astype(np.float32), "normals": drawn.normals(points)})


@command("mesh.texture", reads=True)
def texture(session: Session, request: Request) -> Frame:
    """The picture file of a material, by its number."""
    mesh, number = session.required.mesh, request.integer("id")
    names = mesh.materials.names if mesh.materials is not None else ()
    if not 0 <= number < len(names):
        raise InvalidParameter(f"there is no material {number}")
    material = mesh.material_library.get(names[number])
    if material is None or material.texture is None:
        raise InvalidParameter(f"the material {names[number]!r} has no texture")
    if not session.may_read(material.texture):
        raise InvalidParameter(f"the texture {material.texture.name} lies outside the studio's folder")
    data = read_bytes(material.texture)
    if len(data) > _MOST_TEXTURE:
        raise InvalidParameter(f"the texture {material.texture.name} has {len(data) >> 20} MB; 64 are shown at most")
    return Frame({}, {"file": np.frombuffer(data, np.uint8)})
