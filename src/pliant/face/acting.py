"""A face that acts: its handles as a layer of a stack, and expressions as keys in time."""

from __future__ import annotations

from collections.abc import Iterable

from pliant.deformer import Controls
from pliant.errors import InvalidParameter
from pliant.face.expressions import expression
from pliant.face.face import Face
from pliant.face.handles import FaceHandles
from pliant.scene.clip import Clip
from pliant.scene.layer import Layer
from pliant.scene.stack import Stack

LAYER = "face"


def face_stack(face: Face) -> Stack:
    """A stack whose one layer, ``"face"``, holds the handles of a face, at rest."""
    return Stack((Layer(LAYER, FaceHandles(face.landmarks)),))


def expression_clip(
    face: Face, expressions: Iterable[str | tuple[str, float]], *, seconds: float = 1.0, fps: float = 24.0
) -> Clip:
    """A face that shows one expression after another, and is itself again between them.

    Parameters
    ----------
    face
        A face of any density.
    expressions
        Names of :data:`pliant.face.expressions.EXPRESSIONS`, or names and strengths: 1 where none is given, below zero
        for the opposite.
    seconds
        How long each takes, there and back.
    fps
        Frames a second.

    Raises
    ------
    InvalidParameter
        No expression at all, an unknown one, or a length of time that is not positive.
    """
    named = [(each, 1.0) if isinstance(each, str) else each for each in expressions]
    if not named:
        raise InvalidParameter("no expression is named: a clip needs one or more, such as 'smile'")
    stack = face_stack(face)
    clip = Clip(face.mesh, stack, seconds * len(named), fps, ending="loop")
    clip = _with_key(clip, 0.0, FaceHandles(face.landmarks).rest)
    for at, (name, strength) in enumerate(named):
        rest = FaceHandles(face.landmarks).rest
        clip = _with_key(clip, (at + 0.4) * seconds, rest + strength * expression(name))
        clip = _with_key(clip, (at + 0.6) * seconds, rest + strength * expression(name))
        clip = _with_key(clip, (at + 1.0) * seconds, rest)
    return clip


def _with_key(clip: Clip, time: float, controls: Controls) -> Clip:
    return clip.key(LAYER, time, {"controls": controls}, "ease_in_out")
