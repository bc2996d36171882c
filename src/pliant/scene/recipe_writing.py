"""Stacks and clips as recipes: the numbers that they have, for the mesh that they are on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.io.files import write_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip
from pliant.scene.fields import fields_of
from pliant.scene.keyed import tool_of
from pliant.scene.layer_data import stack_data
from pliant.scene.recipe_layers import RESERVED
from pliant.scene.recipe_values import fields_with_degrees
from pliant.scene.rooms import deformer_classes
from pliant.scene.stack import Stack
from pliant.scene.toml_text import toml_text
from pliant.scene.values import Arrays

MOST = 20_000  # numbers in an array that people could still want to see
_HEADLINE = "# A recipe of pliant. Angles are degrees, lengths are in the mesh's own unit.\n\n"


def write_recipe(
    source: Stack | Clip, path: Path | str, *, title: str = "", about: str = "", mesh: PolygonMesh | None = None
) -> None:
    """Write a stack, or a clip with its keys, as a recipe.

    Parameters
    ----------
    source
        The stack or clip.
    path
        Where to; ``.toml`` is the usual ending.
    title, about
        What people call it, and what it does.
    mesh
        What its numbers were made for: the recipe then fits other meshes, too.

    Raises
    ------
    InvalidParameter
        Something that no file can hold, or an array too large to be read by people: save a project instead.
    UnwritableFile
        The disk is full, or the place is not writable.
    """
    text = _HEADLINE + toml_text(recipe_document(source, title=title, about=about, mesh=mesh))
    write_bytes(path, text.encode())


def recipe_document(
    source: Stack | Clip, *, title: str = "", about: str = "", mesh: PolygonMesh | None = None
) -> dict[str, Any]:
    """A stack or a clip as the document of a recipe, see :func:`write_recipe`.

    Raises
    ------
    InvalidParameter
        The clip has a motion of its own.
    """
    clip, stack = (source, source.stack) if isinstance(source, Clip) else (None, source)
    arrays: Arrays = {}
    data = stack_data(stack, arrays)
    document: dict[str, Any] = {"pliant": 1 if mesh is None else 2}
    document |= {name: text for name, text in (("title", title), ("about", about)) if text}
    if mesh is not None:
        document["box"] = [corner.tolist() for corner in mesh.bounds]
    document["mode"] = stack.mode
    if clip is not None:
        if clip.motion is not None:
            raise InvalidParameter("the clip has a motion of its own: save a project, or export the motion")
        document |= {"duration": clip.duration, "fps": clip.fps, "ending": clip.ending}
    document["layer"] = [_layer(each, arrays) for each in data["layers"]]
    if clip is not None and clip.tracks:
        document["key"] = _keys(clip)
    return document


def _layer(data: dict[str, Any], arrays: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    kind = data["kind"]
    defaults = {field.name: field.default for field in fields_of(deformer_classes()[kind]) if not field.required}
    fields = {name: value for name, value in data["fields"].items() if name not in defaults or defaults[name] != value}
    shown = _inline(fields_with_degrees(kind, fields, inwards=False), arrays)
    rest = {name: _inline(value, arrays) for name, value in data.items() if name not in ("name", "kind", "fields")}
    clash = any(name in RESERVED for name in shown)
    return {"name": data["name"], "kind": kind, **rest, **({"fields": shown} if clash else shown)}


def _keys(clip: Clip) -> list[dict[str, Any]]:
    """One table a key, in the order of time."""
    tables = []
    for track in clip.tracks:
        fields = fields_of(type(tool_of(clip.stack[track.layer].deformer)))
        angles = {field.name for field in fields if field.type == "angle"}
        for key in track.keys:
            value = np.asarray(key.value)
            shown = np.degrees(value) if track.field in angles else value
            easing = key.easing if isinstance(key.easing, str) else list(key.easing)
            plain = float(shown) if shown.ndim == 0 else _shown(shown)
            tables.append({"layer": track.layer, "time": key.time, "easing": easing, track.field: plain})
    return sorted(tables, key=lambda table: float(table["time"]))


def _inline(data: Any, arrays: Mapping[str, NDArray[Any]]) -> Any:
    """Plain data with its arrays in it."""
    if isinstance(data, list):
        return [_inline(item, arrays) for item in data]
    if isinstance(data, dict):
        if isinstance(data.get("array"), str):
            return _shown(arrays[data["array"]])
        return {name: _inline(item, arrays) for name, item in data.items()}
    return data


def _shown(array: NDArray[Any]) -> dict[str, Any]:
    if array.size > MOST:
        raise InvalidParameter(
            f"an array of {array.size:,} numbers is too large for a recipe, which is for people: save a project instead"
        )
    return {"array": array.tolist(), "dtype": array.dtype.name}
