"""Tools that move over the object, and objects that move through a tool: frames of layers, their pivots and their ways.

A map of space is moved by the frame it stands in (Coquillart & Jancene 1991); an affine layer is its own frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.clip import Clip
from pliant.scene.keyed import tool_of
from pliant.scene.layer import Layer
from pliant.space.affine import Affine
from pliant.space.placed import Placed, place

Matrix = NDArray[np.float64]

_MOMENTS = 96  # of a way that is drawn


def frame_field(layer: Layer) -> str:
    """The value of a layer whose keys move it.

    Raises
    ------
    InvalidParameter
        The layer edits a surface, and stands nowhere.
    """
    if not layer.in_space:
        raise InvalidParameter(f"layer {layer.name!r} edits a surface: it moves with it, and cannot be placed")
    return "matrix" if isinstance(layer.deformer, Affine) else "frame"


def frame_of(layer: Layer) -> Matrix:
    """(4, 4) where a layer stands; the identity where it was never placed."""
    deformer = layer.deformer
    if isinstance(deformer, Affine):
        return deformer.matrix
    return deformer.frame.matrix if isinstance(deformer, Placed) else np.eye(4)


def framed(layer: Layer, matrix: Matrix) -> Layer:
    """The layer elsewhere."""
    frame_field(layer)
    if isinstance(layer.deformer, Affine):
        return layer.changed(deformer=Affine(matrix))
    tool = tool_of(layer.deformer)
    assert isinstance(tool, SpaceDeformer)
    return layer.changed(deformer=place(tool, Affine(matrix)))


def pivot_of(layer: Layer, shape: Points) -> Points:
    """(3,) what a layer is taken hold of by, in its own frame: the middle of its control points, or of a shape."""
    tool = tool_of(layer.deformer)
    found = np.asarray(shape)
    if not isinstance(tool, Affine):
        rest = tool.rest
        if rest.ndim > 1 and rest.shape[-1] == 3 and rest.size:
            found = rest.reshape(-1, 3)
    middle: Points = (found.min(axis=0) + found.max(axis=0)) / 2
    return middle


def to_world(deformer: Deformer, points: Points) -> Points:
    """(k, 3) positions in a deformer's own frame, as they are in the world."""
    return deformer.frame(points) if isinstance(deformer, Placed) else points


def to_frame(deformer: Deformer, points: Points) -> Points:
    """(k, 3) positions in the world, as the deformer's own frame has them."""
    return deformer.frame.inverse(points) if isinstance(deformer, Placed) else points


def way_of(clip: Clip, name: str, shape: Points) -> tuple[Points, Points]:
    """The way of a layer's pivot through the clip: (k, 3) places along it, and (m, 3) those of its keys."""
    layer = clip.stack[name]
    field, pivot = frame_field(layer), np.append(pivot_of(layer, shape), 1.0)
    tracks = [track for track in clip.tracks if (track.layer, track.field) == (name, field)]
    if not tracks:
        return np.empty((0, 3)), np.empty((0, 3))
    (track,) = tracks
    first, last = track.keys[0].time, track.keys[-1].time
    along = [(track.at(time) @ pivot)[:3] for time in np.linspace(first, last, _MOMENTS)]
    return np.array(along), np.array([(np.asarray(key.value) @ pivot)[:3] for key in track.keys])
