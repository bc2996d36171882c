"""The fields of a deformer, as its class tells them: what a user can say, in which unit, and what it means."""

from __future__ import annotations

import dataclasses
import inspect
import math
import re
import sys
import typing
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from pliant.deformer import Deformer

FieldType = Literal[
    "number", "integer", "angle", "length", "vector", "axis", "choice", "bool", "text", "profile", "array", "deformer",
    "deformers", "mesh", "object",
]  # fmt: skip

_NEEDED = dataclasses.MISSING
_BY_ANNOTATION: tuple[tuple[str, FieldType], ...] = (
    ("ShapeModel|LowRank|PatchBlock|RoundFrame|Callable|^Profile( |$)", "object"),
    ("tuple\\[SpaceDeformer", "deformers"),
    ("SpaceDeformer|Affine", "deformer"),
    ("PolygonMesh", "mesh"),
    ("ProfileLike", "profile"),
    ("Axis", "axis"),
    ("^bool", "bool"),
    ("^int", "integer"),
    ("^float", "number"),
    ("^str", "text"),
    ("tuple\\[float|tuple\\[int", "vector"),
)
_TURN = 2 * math.pi


@dataclass(frozen=True)
class Field:
    """One thing that a user can say of a deformer.

    Parameters
    ----------
    name
        The argument's name.
    type
        What a form shows for it.
    unit
        ``"radians"``, ``"length"`` (the mesh's own), or nothing.
    default
        What it is when it is left out, as plain data; None also where it must be said, see ``required``.
    required
        Whether it must be said.
    control
        Whether it is one of the numbers that move the deformer: changing it binds nothing anew.
    range
        What a slider would offer; values beyond it are allowed. None where the size of the mesh would say.
    choices
        The words that it may be.
    doc
        What the docstring says of it.
    """

    name: str
    type: FieldType
    unit: str = ""
    default: Any = None
    required: bool = False
    control: bool = False
    range: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()
    doc: str = ""


def fields_of(kind: type[Deformer]) -> tuple[Field, ...]:
    """The fields of a deformer, controls first."""
    docs, hints = documented(kind), _hints(kind)
    controls = getattr(kind, "parameters", ())
    controls = controls if isinstance(controls, tuple) else ()
    found = []
    for field in dataclasses.fields(kind):  # type: ignore[arg-type]  # every kind is a dataclass
        if field.init and field.name != "carrier":
            default, unit = _default(field), str(field.metadata.get("unit", ""))
            made = _field(field.name, str(field.type), hints.get(field.name), default, unit, docs)
            control = field.name in controls
            found.append(dataclasses.replace(made, control=control, range=_range(made, field.metadata, control)))
    return tuple(sorted(found, key=lambda field: not field.control))


def arguments_of(maker: Callable[..., Any], kind: type[Deformer]) -> tuple[Field, ...]:
    """What a way of laying a deformer around a shape can be told; ``**fields`` are the deformer's own."""
    own = {field.name: field for field in fields_of(kind)}
    docs, found = {**documented(kind), **parameters_in(inspect.getdoc(maker) or "")}, []
    for parameter in list(inspect.signature(maker).parameters.values())[1:]:
        if parameter.kind is parameter.VAR_KEYWORD:
            return tuple(own.values())
        default = _NEEDED if parameter.default is parameter.empty else parameter.default
        hint = _resolved(str(parameter.annotation), inspect.unwrap(maker))
        found.append(_field(parameter.name, str(parameter.annotation), hint, default, "", docs))
    return tuple(found)


def documented(kind: type) -> dict[str, str]:
    """What the docstrings of a class and its bases say of each parameter; the nearest that says something wins."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        for name, text in parameters_in(inspect.cleandoc(base.__doc__ or "")).items():
            if name not in found or not text.startswith("See "):
                found[name] = text
    return found


def parameters_in(doc: str) -> dict[str, str]:
    """The parameters that a NumPy docstring describes, each as one line of plain text."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}$|\Z)", doc, re.MULTILINE | re.DOTALL)
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section[1].splitlines() if section else ():
        if line and not line[0].isspace():
            names = [word.strip() for word in line.partition(":")[0].split(",")]
        elif line.strip():
            for name in names:
                found[name] = f"{found.get(name, '')} {plain(line)}".strip()
    return found


def plain(text: str) -> str:
    """Text without the marks of its markup."""
    text = re.sub(r":\w+:`~?(?:[\w.]+\.)?(\w+)`", r"\1", text)
    return text.replace("``", "").strip()


def _field(name: str, annotation: str, hint: Any, default: Any, unit: str, docs: dict[str, str]) -> Field:
    words = _words(hint)
    kind = _type(annotation, words, default, unit)
    shown = None if default is _NEEDED else _shown(default)
    return Field(
        name, kind, unit, shown, default is _NEEDED, choices=words if kind == "choice" else (), doc=docs.get(name, "")
    )


def _type(annotation: str, words: tuple[str, ...], default: Any, unit: str) -> FieldType:
    if unit == "radians":
        return "angle"
    if unit == "length":
        return "length"
    for pattern, kind in _BY_ANNOTATION:
        if re.search(pattern, annotation):
            return kind
    if words:
        return "choice"
    return "vector" if isinstance(default, tuple) and len(default) == 3 else "array"


def _words(hint: Any) -> tuple[str, ...]:
    """The words of a literal, alone or among others."""
    if typing.get_origin(hint) is Literal:
        return tuple(word for word in typing.get_args(hint) if isinstance(word, str))
    return tuple(word for part in typing.get_args(hint) for word in _words(part))


def _hints(kind: type) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for base in reversed(kind.__mro__):
        own = inspect.get_annotations(base)
        found.update({name: _resolved(str(annotation), base) for name, annotation in own.items()})
    return found


def _resolved(annotation: str, owner: Any) -> Any:
    """What an annotation stands for where it is written; None where only a type checker knows."""
    try:
        return eval(annotation, dict(vars(sys.modules[owner.__module__])))  # noqa: S307 -- the library's own source
    except (NameError, TypeError, SyntaxError):
        return None


def _default(field: Any) -> Any:
    if field.default is not dataclasses.MISSING:
        return field.default
    return _NEEDED if field.default_factory is dataclasses.MISSING else field.default_factory()


def _shown(default: Any) -> Any:
    """A default as plain data."""
    if isinstance(default, np.ndarray):
        return default.tolist()
    return list(default) if isinstance(default, tuple) else default


def _range(field: Field, metadata: Any, control: bool) -> tuple[float, float] | None:
    if "range" in metadata:
        low, high = metadata["range"]
        return float(low), float(high)
    if field.type == "angle":
        return -_TURN, _TURN
    if field.type != "number" or not control:
        return None
    return (0.0, 3.0) if field.default else (-1.0, 1.0)
