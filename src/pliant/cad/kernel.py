"""Open CASCADE's modules, by name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from pliant.errors import MissingExtra


def kernel(module: str) -> Any:
    """A module of Open CASCADE, such as ``"BRep"``.

    Raises
    ------
    MissingExtra
        It is not installed.
    """
    try:
        return import_module(f"OCP.{module}")
    except ImportError:
        raise MissingExtra("CAD parts", "cad") from None


def parts_of(shape: Any, kind: str) -> list[Any]:
    """The faces, edges or vertices of a shape, each once."""
    top, names = kernel("TopAbs"), kernel("TopoDS").TopoDS
    explorer = kernel("TopExp").TopExp_Explorer(shape, getattr(top, f"TopAbs_{kind.upper()}"))
    found: dict[int, list[Any]] = {}
    while explorer.More():
        part = explorer.Current()
        same = found.setdefault(hash(part), [])
        if not any(part.IsSame(each) for each in same):
            same.append(part)
        explorer.Next()
    cast = getattr(names, kind.capitalize())
    return [cast(part) for same in found.values() for part in same]


def settled(shape: Any) -> Any:
    """A shape of which each part is where it is without being told, in the same order."""
    flat = kernel("ShapeUpgrade").ShapeUpgrade_RemoveLocations()
    flat.SetRemoveLevel(kernel("TopAbs").TopAbs_COMPOUND)  # also from what compounds hold
    flat.Remove(shape)
    return flat.GetResult()
