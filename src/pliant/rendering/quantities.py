"""What a mesh is coloured by: the name that a user gives becomes numbers, a range and a colour map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Deformer
from pliant.errors import InvalidParameter
from pliant.field.measures import volume_ratio
from pliant.mesh import PolygonMesh
from pliant.rendering.palette import DIVERGING, SEQUENTIAL, Stops, color_table


@dataclass(frozen=True, eq=False)
class Quantity:
    """Numbers to be shown as colours.

    Parameters
    ----------
    title
        What the colour bar says.
    values
        (n,) one a vertex, or (f,) one a face.
    low, high
        Ends of the colour bar.
    table
        (256, 3) colours from low to high.
    on_faces
        Whether the values belong to faces.
    """

    title: str
    values: NDArray[np.float64]
    low: float
    high: float
    table: NDArray[np.float64]
    on_faces: bool = False


def quantity(
    color: str | ArrayLike,
    before: PolygonMesh,
    after: PolygonMesh,
    deformer: Deformer | None,
    limits: tuple[float, float] | None,
    sequence: Stops = SEQUENTIAL,
) -> Quantity:
    """The numbers behind a colour.

    Parameters
    ----------
    color
        ``"displacement"``, ``"x"``, ``"y"``, ``"z"`` (after the deformation), ``"volume ratio"``, the name of a
        vertex or face attribute (of vectors: their length), or (n,) or (f,) numbers.
    before, after
        The mesh at rest and deformed.
    deformer
        What lies between; None = nothing.
    limits
        Ends of the colour bar; None = those of the values, and symmetric about one for the volume ratio.
    sequence
        The colours from low to high; the volume ratio has its own.

    Raises
    ------
    InvalidParameter
        An unknown name, or numbers of another length.
    """
    title, values = _values(color, before, after, deformer)
    if values.ndim == 2:
        title, values = f"|{title}|", np.linalg.norm(values, axis=1)
    on_faces = len(values) != len(after.points)
    if values.ndim != 1 or (on_faces and len(values) != len(after.faces)):
        raise InvalidParameter(
            f"a colour of shape {values.shape} fits neither {len(after.points)} vertices nor {len(after.faces)} faces"
        )
    if not np.isfinite(values).all():
        raise InvalidParameter(f"{np.count_nonzero(~np.isfinite(values))} values of the colour are not finite")
    about_one = isinstance(color, str) and color == "volume ratio"
    low, high = limits or _limits(values, about_one=about_one)
    if not (np.isfinite([low, high]).all() and low < high):
        raise InvalidParameter(f"limits are a low and a higher number; given: {limits}")
    return Quantity(title, values, low, high, color_table(DIVERGING if about_one else sequence), on_faces)


def painted(paint: Quantity) -> NDArray[np.uint8]:
    """(n, 3) the colours of a quantity's values; those beyond an end have the end's."""
    place = np.clip((paint.values - paint.low) / (paint.high - paint.low), 0, 1) * (len(paint.table) - 1)
    below = np.minimum(place.astype(int), len(paint.table) - 2)
    part = (place - below)[:, None]
    colors = (1 - part) * paint.table[below] + part * paint.table[below + 1]
    return np.asarray(np.rint(255 * colors), np.uint8)


def _values(
    color: str | ArrayLike, before: PolygonMesh, after: PolygonMesh, deformer: Deformer | None
) -> tuple[str, NDArray[np.float64]]:
    if not isinstance(color, str):
        return "", np.asarray(color, np.float64)
    if color == "displacement":
        return color, np.asarray(np.linalg.norm(after.points - before.points, axis=1))
    if color in {"x", "y", "z"}:
        return color, after.points[:, "xyz".index(color)]
    if color == "volume ratio":
        return color, np.ones(len(before.points)) if deformer is None else volume_ratio(deformer, before)
    for attributes in (after.vertex_attributes, after.face_attributes):
        if color in attributes:
            return color, np.asarray(attributes[color], np.float64)
    known = ["texture", "displacement", "x", "y", "z", "volume ratio", *after.vertex_attributes, *after.face_attributes]
    raise InvalidParameter(f"nothing to colour by is called {color!r}; there are: {', '.join(known)}")


def _limits(values: NDArray[np.float64], *, about_one: bool) -> tuple[float, float]:
    """The ends of the values, never the same; symmetric about one if asked."""
    if not len(values):
        return 0.0, 1.0
    low, high = float(values.min()), float(values.max())
    if about_one:
        reach = max(high - 1, 1 - low, 1e-3)
        return 1 - reach, 1 + reach
    return (low, high) if high > low else (low, low + (abs(low) or 1.0) * 1e-3)
