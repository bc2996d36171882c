"""Parts of a shape that have names: groups, objects, materials, selections."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.scene.scene import Scene

_MOST = 200


def parts_of(scene: Scene) -> tuple[str, ...]:
    """The names of the parts."""
    mesh = scene.mesh
    labels = [labels for labels in (mesh.groups, mesh.objects, mesh.materials) if labels is not None]
    names = [name for each in labels if len(each.names) > 1 for name in each.names]
    return tuple(dict.fromkeys([*scene.selections, *names]))[:_MOST]


def vertices_of(scene: Scene, part: str) -> NDArray[np.int64]:
    """The vertices of a part, sorted.

    Raises
    ------
    InvalidParameter
        There is no such part, or nothing in it.
    """
    if part in scene.selections:
        found = np.unique(np.asarray(scene.selections[part], np.int64))
    else:
        mesh = scene.mesh
        labels = [
            each for each in (mesh.groups, mesh.objects, mesh.materials) if each is not None and part in each.names
        ]
        if not labels:
            raise InvalidParameter(f"there is no part {part!r}; there are: {', '.join(parts_of(scene)) or 'none'}")
        chosen = labels[0].indices == labels[0].names.index(part)
        found = np.unique(mesh.faces.flat[chosen[mesh.faces.row_of]]).astype(np.int64)
    if not len(found):
        raise InvalidParameter(f"the part {part!r} is empty")
    return found
