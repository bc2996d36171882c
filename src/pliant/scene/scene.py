"""Scene: a shape, the stack that deforms it, how it moves in time, and what has been selected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import frozen
from pliant.scene.clip import Clip
from pliant.scene.stack import Stack


@dataclass(frozen=True, eq=False)
class Scene:
    """A shape and what is done to it: frozen, so that a history is a list of scenes.

    Parameters
    ----------
    mesh
        The shape at rest.
    stack
        What deforms it.
    clip
        How it moves in time; None where it does not. It is put on this mesh and this stack: keys of layers that are
        not there are left out.
    selections
        Vertices by name.

    Raises
    ------
    InvalidParameter
        A selection of vertices that the mesh has not.
    """

    mesh: PolygonMesh
    stack: Stack = field(default_factory=Stack)
    clip: Clip | None = None
    selections: Mapping[str, ArrayLike] = field(default_factory=dict)

    def __post_init__(self) -> None:
        kept = {name: _checked(name, chosen, len(self.mesh.points)) for name, chosen in self.selections.items()}
        object.__setattr__(self, "selections", MappingProxyType(kept))
        if self.clip is not None and (self.clip.mesh is not self.mesh or self.clip.stack is not self.stack):
            object.__setattr__(self, "clip", self.clip.on(self.mesh, self.stack))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.mesh, self.stack, self.clip, dict(self.selections))

    def replace(self, **changes: Any) -> Scene:
        """The same scene with some fields exchanged."""
        return replace(self, **changes)

    def deformed(self) -> PolygonMesh:
        """The shape as the stack deforms it."""
        return self.stack(self.mesh)


def _checked(name: str, chosen: ArrayLike, count: int) -> NDArray[np.int64]:
    vertices = np.asarray(chosen)
    if vertices.size == 0:
        vertices = vertices.astype(np.int64)
    if vertices.ndim != 1 or not np.issubdtype(vertices.dtype, np.integer):
        raise InvalidParameter(f"selection {name!r} holds vertex indices, (k,); given: {vertices.dtype}")
    if vertices.size and not 0 <= vertices.min() <= vertices.max() < count:
        worst = vertices.min() if vertices.min() < 0 else vertices.max()
        raise InvalidParameter(f"selection {name!r} holds vertex {worst}; the mesh has {count:,}, counted from 0")
    result: NDArray[np.int64] = frozen(vertices, np.int64)
    return result
