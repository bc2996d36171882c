"""Expressions: what a smile or raised brows do to the handles of a face, and how much of them a face shows."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls
from pliant.errors import InvalidParameter
from pliant.face.features import HANDLES
from pliant.face.handles import FaceHandles
from pliant.face.topology import mean_face

Floats = NDArray[np.float64]

# Centimetres of the mean face: x away from the middle, y up, z towards the viewer; "brow" stands for either side.
EXPRESSIONS: Mapping[str, Mapping[str, tuple[float, float, float]]] = MappingProxyType(
    {
        "smile": {
            "mouth corner": (0.75, 0.75, -0.55),
            "upper lip": (0.0, 0.2, -0.3),
            "lower lip": (0.0, 0.1, -0.3),
            "cheek": (0.1, 0.4, 0.15),
            "lower lid": (0.0, 0.12, 0.0),
        },
        "open mouth": {
            "lower lip": (0.0, -1.5, -0.35),
            "chin": (0.0, -1.7, -0.45),
            "jaw": (0.0, -0.8, -0.2),
            "mouth corner": (-0.1, -0.5, -0.1),
            "cheek": (0.0, -0.15, 0.0),
        },
        "raised brows": {
            "brow inner": (0.0, 0.8, 0.0),
            "brow outer": (0.0, 0.7, 0.0),
            "upper lid": (0.0, 0.2, 0.0),
            "forehead": (0.0, 0.1, 0.0),
        },
        "frown": {
            "brow inner": (-0.35, -0.55, 0.15),
            "brow outer": (-0.1, -0.2, 0.0),
            "upper lid": (0.0, -0.12, 0.0),
            "mouth corner": (-0.1, -0.25, 0.0),
        },
        "sadness": {
            "brow inner": (-0.1, 0.5, 0.1),
            "brow outer": (0.0, -0.2, 0.0),
            "mouth corner": (0.05, -0.5, 0.0),
            "lower lip": (0.0, 0.15, 0.15),
            "upper lid": (0.0, -0.15, 0.0),
        },
        "kiss": {
            "mouth corner": (-0.9, 0.0, 0.5),
            "upper lip": (0.0, 0.1, 0.5),
            "lower lip": (0.0, -0.1, 0.5),
            "cheek": (-0.2, 0.0, 0.1),
        },
        "closed eyes": {"upper lid": (0.0, -0.38, 0.0), "lower lid": (0.0, 0.06, 0.0)},
    }
)


def expression(name: str) -> Controls:
    """(h, 3) the displacement of each handle in an expression of full strength.

    Raises
    ------
    InvalidParameter
        There is no such expression.
    """
    if name not in EXPRESSIONS:
        raise InvalidParameter(f"no expression is called {name!r}; there are: {', '.join(EXPRESSIONS)}")
    moves = np.zeros((len(HANDLES), 3))
    for at, handle in enumerate(HANDLES):
        words = handle.split(" ")
        side = 1.0 if "left" in words else -1.0 if "right" in words else 0.0
        middle = " ".join(word for word in words if word not in ("left", "right"))
        moves[at] = np.multiply(EXPRESSIONS[name].get(middle, (0.0, 0.0, 0.0)), [side, 1.0, 1.0])
    return moves


@cache
def expression_fields() -> Floats:
    """(e, 468, 3) how each expression moves the landmarks of the mean face."""
    points = mean_face().points
    bound = FaceHandles(points).bind(points)
    return np.array([bound.jvp(None, expression(name)) for name in EXPRESSIONS])
