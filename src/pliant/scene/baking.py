"""Baking: layers become part of the mesh, or shape keys of it."""

from __future__ import annotations

import numpy as np

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.stack import Stack
from pliant.surface.shape_keys import ShapeKeys


def bake(stack: Stack, mesh: PolygonMesh, name: str | None = None) -> tuple[PolygonMesh, Stack]:
    """The mesh as the layers up to one deform it, and the stack of those above.

    Parameters
    ----------
    stack, mesh
        What is baked, on what.
    name
        The last layer that is baked; None = all are.

    Returns
    -------
    mesh, stack
        Together they are what they were together.

    Raises
    ------
    InvalidParameter
        No such layer; or what is left would not do the same: it edits the surface of the shape at rest, or the stack
        adds displacements from rest.
    """
    last = len(stack) if name is None else stack.index(name) + 1
    below, above = Stack(stack.layers[:last], stack.mode), Stack(stack.layers[last:], stack.mode)
    if any(layer.solo and not layer.muted for layer in stack):
        raise InvalidParameter("a layer is solo, so that others are left out: end that before baking")
    if below.active and above.active:
        if stack.mode == "add":
            raise InvalidParameter("layers that are added start from the shape at rest: bake all of them, or none")
        for layer in above.active:
            if not layer.in_space:
                raise InvalidParameter(f"layer {layer.name!r} edits the shape at rest: bake it too, or move it down")
    return below(mesh), above


def bake_shape_keys(stack: Stack, mesh: PolygonMesh) -> ShapeKeys:
    """Every active layer as a shape key: what it adds to the result of those below, with weight 1.

    With all weights 1 the keys are the stack; with others each layer is more or less of itself, in proportion.

    Parameters
    ----------
    stack
        Whose layers become keys, named as they are.
    mesh
        The shape at rest, whose vertices the keys move.
    """
    before, moves, names = mesh.points, [], []
    for count, layer in enumerate(stack.active, start=1):
        after = Stack(tuple(each.changed(solo=False) for each in stack.active[:count]), stack.mode)(mesh).points
        moves.append(after - before)
        names.append(layer.name)
        before = after
    return ShapeKeys(np.array(moves).reshape(-1, len(mesh.points), 3), tuple(names), np.ones(len(names)))
