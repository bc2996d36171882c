"""The scene as a page is told it: the document, its mesh, its layers with their fields, its history."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from pliant.deformer import Deformer, LinearBinding
from pliant.errors import PliantError
from pliant.scene.fields import Field
from pliant.scene.keyed import tool_of
from pliant.scene.kinds import kind_of
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.values import encode
from pliant.studio.modes.axial.tool import holds
from pliant.studio.modes.clip_state import clip_state
from pliant.studio.modes.lattices import lattice_shape
from pliant.studio.seen.parts import parts_of
from pliant.studio.seen.titles import titled

if TYPE_CHECKING:
    from pliant.studio.session import Session

PLAIN = {"number", "length", "angle", "integer", "bool", "choice", "vector", "axis", "text"}


def scene_state(session: Session) -> dict[str, Any]:
    """What a page knows of the scene."""
    scene, history = session.scene, session.history
    if scene is None or history is None or session.stage is None:
        empty: dict[str, Any] = {"labels": [], "position": 0}
        nothing: dict[str, Any] = {"mesh": None, "layers": [], "clip": None, "history": empty}
        return {"revision": session.revision, "name": "", "dirty": False, **nothing}
    return {
        "revision": session.revision,
        "name": session.name,
        "dirty": session.revision != session.saved,
        "mesh": _mesh(scene, session.stage.id, session.name),
        "layers": [_layer(layer) for layer in scene.stack],
        "selections": [{"name": name, "count": len(np.asarray(ids))} for name, ids in scene.selections.items()],
        "clip": clip_state(scene, session.time, session.recording),
        "history": {
            "labels": [{"key": entry.key, "subject": entry.subject} for entry in history.entries],
            "position": history.position,
        },
    }


def _mesh(scene: Scene, number: int, name: str) -> dict[str, Any]:
    mesh = scene.mesh
    low, high = mesh.bounds
    return {
        "id": number,
        "name": name,
        "points": len(mesh.points),
        "faces": len(mesh.faces),
        "bounds": [low, high],
        "center": mesh.center,
        "diagonal": mesh.diagonal or 1.0,
        "textured": any(material.texture for material in mesh.material_library.values()),
        "closed": mesh.edge_use == (0, 0),
        "parts": list(parts_of(scene)),
    }


def _layer(layer: Layer) -> dict[str, Any]:
    deformer = layer.deformer
    by_points = layer.in_space and deformer.controls.ndim > 1 and deformer.controls.shape[-1] == 3
    try:
        tool = tool_of(deformer)
        kind = kind_of(tool)
        name, fields = kind.name, [_field(field, tool) for field in kind.fields]
    except PliantError:
        name, fields = type(deformer).__name__, []
    return {
        "name": layer.name,
        "kind": name,
        "title": titled(name),
        "muted": layer.muted,
        "solo": layer.solo,
        "envelope": layer.envelope,
        "fields": fields,
        "points": deformer.controls.size // 3 if by_points else 0,
        "shape": lattice_shape(deformer),
        "linear": by_points and _is_linear(deformer),
        "transform": layer.in_space,
        "axial": holds(deformer),
    }


def _is_linear(deformer: Deformer) -> bool:
    """Whether it can be pulled by points of the surface: its kind's bindings are linear."""
    kind = type(deformer)
    if kind not in _linear:
        try:
            _linear[kind] = isinstance(deformer.bind(deformer.rest.reshape(-1, 3)[:1]), LinearBinding)
        except PliantError:
            return False
    return _linear[kind]


_linear: dict[type[Deformer], bool] = {}


def _field(field: Field, deformer: Deformer) -> dict[str, Any]:
    value = getattr(deformer, field.name, None)
    if isinstance(value, np.ndarray) and value.size > 16:
        shown: Any = " × ".join(map(str, value.shape))
    else:
        shown = encode(value, {}, field.name, opaque=lambda thing: type(thing).__name__)
    simple = isinstance(shown, bool | int | float | str) or (
        isinstance(shown, list) and len(shown) == 3 and all(isinstance(each, int | float) for each in shown)
    )
    return {**asdict(field), "value": shown, "editable": field.type in PLAIN and simple}
