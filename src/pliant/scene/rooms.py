"""What there is: every deformer, and every frozen record that one is made of, found where it is defined.

Nothing is listed. A deformer exists when its class does: one that is new in the rooms of deformers, or that a user
has written, is found like all others.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re
from functools import cache
from types import ModuleType
from typing import Any

from pliant.deformer import Deformer

ROOMS = ("pliant.space", "pliant.surface", "pliant.shape")
ABOVE = ("pliant.face.caricature_deformer", "pliant.face.handles")  # deformers in rooms above this one
RECORDS = ("pliant.attributes", "pliant.mesh", "pliant.numerics.lattices.patch_block", "pliant.numerics.ragged")


def deformer_classes() -> dict[str, type[Deformer]]:
    """Every deformer that can be made, by the name of its kind, sorted."""
    _modules()
    found: dict[str, type[Deformer]] = {}
    for kind in _below(Deformer):  # type: ignore[type-abstract]
        if kind.__module__ != "pliant.scene.stack" and _can_be_made(kind):
            name = kind_name(kind)
            if name not in found or kind.__module__.startswith("pliant."):
                found[name] = kind
    return dict(sorted(found.items()))


@cache
def known_as(kind: type[Deformer]) -> str | None:
    """The name by which a kind of deformer is found, if it is."""
    name = kind_name(kind)
    return name if deformer_classes().get(name) is kind else None


def kind_name(kind: type) -> str:
    """The name of a kind: ``BSplineFFD`` is ``bspline-ffd``."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "-", kind.__name__).lower()


@cache
def records() -> dict[str, type[Any]]:
    """Every frozen record but deformers that a deformer or a mesh can hold, by its class's name."""
    modules = (*_modules(), *map(importlib.import_module, RECORDS))
    return {
        name: kind
        for module in modules
        for name, kind in inspect.getmembers(module, inspect.isclass)
        if kind.__module__ == module.__name__ and dataclasses.is_dataclass(kind) and not issubclass(kind, Deformer)
    }


def _can_be_made(kind: type) -> bool:
    return dataclasses.is_dataclass(kind) and not inspect.isabstract(kind) and not kind.__name__.startswith("_")


@cache
def _modules() -> tuple[ModuleType, ...]:
    names = []
    for room in map(importlib.import_module, ROOMS):
        names += [f"{room.__name__}.{entry.name}" for entry in pkgutil.iter_modules(room.__path__)]
    return tuple(map(importlib.import_module, (*names, *ABOVE)))


def _below(kind: type[Deformer]) -> list[type[Deformer]]:
    found = []
    for child in kind.__subclasses__():
        found += [child, *_below(child)]
    return found
