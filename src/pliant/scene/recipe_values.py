"""Values as recipes say them: angles in degrees, and lengths and places as parts of the shape, such as ``"30 %"``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.fields import Field
from pliant.scene.motions import between
from pliant.scene.rooms import deformer_classes
from pliant.space.affine import Affine

Floats = NDArray[np.float64]

_PERCENT = re.compile(r"\s*([+-]?\d+(?:\.\d+)?)\s*%\s*")
MOTION = ("move", "turn", "axis", "about", "scale")


@dataclass(frozen=True, eq=False)
class Box:
    """What parts of a shape are parts of.

    Parameters
    ----------
    low, high
        (3,) the corners of its bounding box.
    """

    low: Floats
    high: Floats

    @classmethod
    def of(cls, mesh: PolygonMesh) -> Box:
        """The box of a mesh."""
        return cls(*mesh.bounds)

    @property
    def diagonal(self) -> float:
        """The length of its diagonal."""
        return float(np.linalg.norm(self.high - self.low)) or 1.0

    def place(self, value: Any) -> Floats:
        """(3,) a position; percent count from the low corner along each axis."""
        parts = zip(_three(value), self.low, self.high, strict=True)
        return np.array([_part(item, low, high) for item, low, high in parts])

    def step(self, value: Any) -> Floats:
        """(3,) a displacement; percent are those of the extents."""
        parts = zip(_three(value), self.high - self.low, strict=True)
        return np.array([_part(item, 0.0, extent) for item, extent in parts])

    def length(self, value: Any) -> float:
        """A length; percent are those of the diagonal."""
        return _part(value, 0.0, self.diagonal)


def field_value(value: Any, field: Field, box: Box) -> Any:
    """A field's value from what a recipe says.

    Raises
    ------
    InvalidParameter
        No number where one is needed, or percent where there is nothing that they could be part of.
    """
    if field.type == "angle":
        return math.radians(_part(value, None, None))
    if field.type == "length":
        return box.length(value)
    if field.type == "vector" and isinstance(value, list) and len(value) == 3 and _relative(value):
        return box.place(value)
    if _relative(value):
        raise InvalidParameter(
            f"{field.name!r} cannot be given in percent: there is nothing that it would be a part of"
        )
    return value


def along_value(value: Any, whole: tuple[float, float]) -> Any:
    """A position, or several; percent count from the low end of the whole shape to its high end."""
    if isinstance(value, list):
        return tuple(_part(item, *whole) for item in value)
    return _part(value, *whole)


def motion_matrix(values: Mapping[str, Any], box: Box, intensity: float) -> Floats:
    """(4, 4) a motion: first scaled, then turned by degrees about an axis, both about a place, then moved.

    Raises
    ------
    InvalidParameter
        A word that motions do not have.
    """
    for name in values:
        if name not in MOTION:
            raise InvalidParameter(f"a motion has no {name!r}; it has: {', '.join(MOTION)}")
    about = box.place(values.get("about", ["50 %", "50 %", "0 %"]))
    turn = Affine.rotation(values.get("axis", "z"), math.radians(_part(values.get("turn", 0.0), None, None)), about)
    scale = Affine.scaling(values.get("scale", 1.0), about)
    whole = turn.matrix @ scale.matrix
    whole[:3, 3] += box.step(values.get("move", [0.0, 0.0, 0.0]))
    return between(np.eye(4), whole, intensity) if intensity != 1.0 else whole


def with_degrees(data: Any, *, inwards: bool) -> Any:
    """Plain data of deformers with all angles in degrees, from radians; or back, ``inwards``."""
    if isinstance(data, list):
        return [with_degrees(item, inwards=inwards) for item in data]
    if not isinstance(data, dict):
        return data
    if "kind" in data and isinstance(data.get("fields"), dict):
        return {**data, "fields": fields_with_degrees(str(data["kind"]), data["fields"], inwards=inwards)}
    return {name: with_degrees(item, inwards=inwards) for name, item in data.items()}


def fields_with_degrees(kind: str, fields: Mapping[str, Any], *, inwards: bool) -> dict[str, Any]:
    """As :func:`with_degrees`, for the fields of one deformer."""
    from pliant.scene.fields import fields_of

    cls = deformer_classes().get(kind)
    angles = {field.name for field in fields_of(cls) if field.type == "angle"} if cls is not None else set()
    turn = math.radians if inwards else math.degrees
    return {
        name: turn(item) if name in angles and isinstance(item, int | float) else with_degrees(item, inwards=inwards)
        for name, item in fields.items()
    }


def _relative(value: Any) -> bool:
    if isinstance(value, list):
        return any(map(_relative, value))
    return isinstance(value, str) and _PERCENT.fullmatch(value) is not None


def _part(value: Any, low: float | None, high: float | None) -> float:
    """A number, or a part of the way from one to another."""
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    found = _PERCENT.fullmatch(value) if isinstance(value, str) else None
    if found is None or low is None or high is None:
        raise InvalidParameter(f"{value!r} is no number" + ("" if low is None else ", nor percent such as '30 %'"))
    return float(low + float(found[1]) / 100 * (high - low))


def _three(value: Any) -> list[Any]:
    if not isinstance(value, list) or len(value) != 3:
        raise InvalidParameter(f"{value!r} is no place: three numbers are needed, or percent such as '30 %'")
    return value
