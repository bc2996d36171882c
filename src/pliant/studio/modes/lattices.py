"""Lattices as pages see them: how many control points along each axis, which are neighbours, which way they stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import PliantError
from pliant.mesh import Points
from pliant.scene.keyed import tool_of
from pliant.space.extended_ffd import ExtendedFFD
from pliant.studio.modes.placements import to_world


def lattice_shape(deformer: Deformer) -> list[int] | None:
    """(nx, ny, nz) of a lattice; None for what is none."""
    try:
        controls = deformer.controls
    except PliantError:  # a surface deformer rests where its mesh does
        return None
    return list(controls.shape[:3]) if controls.ndim == 4 else None


def links(deformer: Deformer) -> NDArray[np.uint32]:
    """(e, 2) control points that are joined by a line: neighbours in a lattice, edges of a cage."""
    shape = lattice_shape(deformer)
    if shape is None:
        return np.asarray(getattr(tool_of(deformer), "links", np.empty((0, 2))), np.uint32)
    index = np.arange(int(np.prod(shape)), dtype=np.uint32).reshape(shape)
    found = []
    for axis in range(3):
        first, second = np.delete(index, -1, axis), np.delete(index, 0, axis)
        found.append(np.stack([first.reshape(-1), second.reshape(-1)], axis=1))
    return np.concatenate(found)


def places_around(deformer: Deformer) -> NDArray[np.int32] | None:
    """(m, 3) places around, outwards and along of a round lattice; -1 where a control point stands at several.

    None for what is no lattice of one block.
    """
    lattice = tool_of(deformer)
    if not isinstance(lattice, ExtendedFFD) or len(lattice.blocks) != 1:
        return None
    index = lattice.blocks[0].index
    found = np.full((len(lattice.points), 3), -1, np.int32)
    for axis, at in enumerate(np.indices(index.shape)):
        least, most = np.full(len(found), index.size), np.full(len(found), -1)
        np.minimum.at(least, index.reshape(-1), at.reshape(-1))
        np.maximum.at(most, index.reshape(-1), at.reshape(-1))
        found[:, axis] = np.where(least == most, most, -1)
    return found


def axes_of(deformer: Deformer) -> Points:
    """(3, 3) unit columns: the axes of the world along which a lattice's control points stand in rows."""
    rest = deformer.rest
    rest = to_world(deformer, rest.reshape(-1, 3)).reshape(rest.shape)
    axes = np.eye(3)
    if rest.ndim == 4:
        for axis in range(3):
            if rest.shape[axis] > 1:
                step = np.take(rest, 1, axis).reshape(-1, 3)[0] - np.take(rest, 0, axis).reshape(-1, 3)[0]
                axes[:, axis] = step / (np.linalg.norm(step) or 1.0)
    return axes


def principal_axes(points: Points) -> Points:
    """(3, 3) right-handed columns along which a shape extends most, then less; each nearest to a coordinate axis."""
    centered = points - points.mean(axis=0)
    _, vectors = np.linalg.eigh(centered.T @ centered)
    axes = np.zeros((3, 3))
    left = [0, 1, 2]
    for target in range(3):
        best = max(left, key=lambda column: abs(vectors[target, column]))
        left.remove(best)
        axes[:, target] = vectors[:, best] * (1 if vectors[target, best] >= 0 else -1)
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    return axes
