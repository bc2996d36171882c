"""The layers of a recipe, laid around a mesh."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.fitting import Fit, exaggerated
from pliant.scene.keyed import tool_of
from pliant.scene.kinds import Kind, all_kinds, build, kind_of
from pliant.scene.layer import Layer
from pliant.scene.layer_data import SWITCHES
from pliant.scene.recipe_values import (
    MOTION,
    Box,
    along_value,
    field_value,
    fields_with_degrees,
    motion_matrix,
)
from pliant.scene.values import decode
from pliant.space.affine import Affine

Floats = NDArray[np.float64]
_ALONG = ("bounds", "center")  # positions along the deformer's own axis
RESERVED = ("name", "kind", "around", "fields", "mask", "envelope", "moves", *SWITCHES)


def layer_around(data: Mapping[str, Any], mesh: PolygonMesh, intensity: float, fit: Fit | None = None) -> Layer:
    """One layer of a recipe.

    Parameters
    ----------
    data
        Its table.
    mesh
        What it is laid around.
    intensity
        How far its numbers are from those at rest: 1 = as the recipe says.
    fit
        From the box that its numbers were made for, where the recipe names one.

    Raises
    ------
    InvalidParameter
        An unknown kind or field, or a value that is not understood; the layer is named.
    """
    name, label = data.get("name"), data.get("kind")
    if not isinstance(name, str) or not isinstance(label, str):
        raise InvalidParameter(f"a layer needs a name and a kind, both words; given: {name!r} and {label!r}")
    if label not in all_kinds():
        raise InvalidParameter(
            f"layer {name!r}: there is no kind of deformer {label!r}; there are: {', '.join(all_kinds())}"
        )
    given = data.get("fields", {})
    if not isinstance(given, dict):
        raise InvalidParameter(f"layer {name!r}: its fields are no table")
    fields = {**{key: value for key, value in data.items() if key not in RESERVED}, **given}
    try:
        deformer = _deformer(all_kinds()[label], fields, data, mesh, intensity)
        if fit is not None and "around" not in data:
            deformer = fit.deformer(deformer)
        switches = {switch: bool(data.get(switch, False)) for switch in SWITCHES}
        mask = _mask(data["mask"], mesh) if "mask" in data else None
        return Layer(name, deformer, mask, envelope=data.get("envelope", 1.0), **switches)
    except InvalidParameter as error:
        raise InvalidParameter(f"layer {name!r}: {error}") from error


def keyed_values(
    data: Mapping[str, Any], layer: Layer, mesh: PolygonMesh, intensity: float, fit: Fit | None = None
) -> dict[str, Any]:
    """The values of a key of a recipe, as :meth:`Clip.key` takes them; of layers that were fitted, fitted."""
    values = {name: value for name, value in data.items() if name not in ("layer", "time", "easing")}
    box = Box.of(mesh)
    if values and all(name in MOTION for name in values) and isinstance(layer.deformer, Affine):
        return {"matrix": motion_matrix(values, box, intensity)}
    kind = kind_of(tool_of(layer.deformer))
    fields = {field.name: field for field in kind.fields}
    found: dict[str, Any] = {}
    for name, value in values.items():
        if name in ("envelope", "muted", "controls", "frame"):
            found[name] = np.asarray(decode(value, {}), np.float64)
            if name == "controls" and intensity != 1.0 and layer.in_space:
                found[name] = layer.deformer.rest + intensity * (found[name] - layer.deformer.rest)
        elif name in fields:
            plain = decode(field_value(value, fields[name], box), {})
            found[name] = _intense(kind, name, plain, intensity)
        else:
            raise InvalidParameter(f"a key of layer {layer.name!r} has no {name!r}; there are: {', '.join(fields)}")
    return found if fit is None else {name: fit.field(layer.deformer, name, value) for name, value in found.items()}


def _deformer(
    kind: Kind, fields: dict[str, Any], data: Mapping[str, Any], mesh: PolygonMesh, intensity: float
) -> Deformer:
    if kind.cls is Affine and any(name in MOTION for name in fields):
        return Affine(motion_matrix(fields, Box.of(mesh), intensity))
    if "around" not in data:
        made = build(kind.name, fields_with_degrees(kind.name, fields, inwards=True))
        return _exaggerated(kind, made, intensity)
    maker = str(data["around"]) if data["around"] is not True else "around"
    known = {field.name: field for field in kind.makers.get(maker, ())}
    box, values = Box.of(mesh), {}
    for name, value in fields.items():
        if name not in known:
            raise InvalidParameter(f"{maker} of a {kind.name} knows no {name!r}; it knows: {', '.join(known)}")
        if name not in _ALONG:
            plain = decode(field_value(value, known[name], box), {})
            values[name] = _intense(kind, name, plain, intensity)
    made = kind.around(mesh, values, maker)
    whole: Any = getattr(made, "bounds", (0.0, 1.0))
    along = {name: along_value(fields[name], whole) for name in _ALONG if name in fields}
    if along:
        made = replace(made, **along)  # type: ignore[type-var]
    return _with_moves(made, data.get("moves", ()), box, intensity)


def _intense(kind: Kind, name: str, value: Any, intensity: float) -> Any:
    """A number further from rest, or nearer to it; what does not rest anywhere stays."""
    neutral: Mapping[str, float] = getattr(kind.cls, "neutral", {})
    if intensity == 1.0 or name not in neutral or not isinstance(value, int | float):
        return value
    if neutral[name] == 1.0 and value > 0:
        return math.exp(intensity * math.log(value))  # factors: twice as intense is applied twice
    return neutral[name] + intensity * (value - neutral[name])


def _exaggerated(kind: Kind, deformer: Deformer, intensity: float) -> Deformer:
    """A deformer whose numbers are given, further from rest, or nearer to it."""
    neutral: Mapping[str, float] = getattr(kind.cls, "neutral", {})
    if intensity == 1.0 or not neutral:
        return exaggerated(deformer, intensity)
    values = {name: _intense(kind, name, float(getattr(deformer, name)), intensity) for name in neutral}
    return replace(deformer, **values)  # type: ignore[type-var]


def _with_moves(deformer: Deformer, moves: Any, box: Box, intensity: float) -> Deformer:
    """Control points of a lattice moved: ``{at = [0, "*", 3], by = ["10 %", 0, 0]}``, a star being all."""
    if not moves:
        return deformer
    if not isinstance(deformer, SpaceDeformer) or deformer.controls.ndim != 4:
        raise InvalidParameter("only lattices have control points to move")
    controls = deformer.controls.copy()
    for move in moves if isinstance(moves, list) else [moves]:
        if not isinstance(move, dict) or set(move) != {"at", "by"}:
            raise InvalidParameter(
                f"{move!r} is no move of control points, as in {{ at = [0, '*', 3], by = ['10 %', 0, 0] }}"
            )
        place = tuple(slice(None) if at == "*" else at for at in move["at"])
        try:
            controls[place] += intensity * box.step(move["by"])
        except (IndexError, TypeError, ValueError) as error:
            raise InvalidParameter(f"there are no control points at {move['at']!r}: {error}") from error
    return deformer.moved(controls)


def _mask(data: Any, mesh: PolygonMesh) -> Floats:
    """Weights: numbers, or ``{axis = "z", from = "40 %", to = "60 %"}``, which rise smoothly from 0 to 1."""
    if not isinstance(data, dict) or "axis" not in data:
        return np.asarray(decode(data, {}), np.float64)
    box = Box.of(mesh)
    if data["axis"] not in ("x", "y", "z") or not {"from", "to"} <= set(data):
        raise InvalidParameter("a mask along an axis says axis = 'x', 'y' or 'z', from and to")
    axis = "xyz".index(data["axis"])
    low, high = (float(box.place([data[end]] * 3)[axis]) for end in ("from", "to"))
    if low == high:
        raise InvalidParameter("a mask must rise over some length: from and to are the same")
    part = np.clip((mesh.points[:, axis] - low) / (high - low), 0.0, 1.0)
    return np.asarray(part * part * (3 - 2 * part))
