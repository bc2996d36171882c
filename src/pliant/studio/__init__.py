"""The studio: an editor in the browser, served by this machine for this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pliant.studio.showing import Studio as Studio
    from pliant.studio.showing import show as show
    from pliant.studio.widget import Widget as Widget

_PLACES = {
    "show": "pliant.studio.showing",
    "Studio": "pliant.studio.showing",
    "Widget": "pliant.studio.widget",
}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return sorted(_PLACES)
