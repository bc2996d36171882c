"""Project files of older versions, made into those of today: one step a version."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

VERSION = 2


def _with_clip(manifest: dict[str, Any]) -> dict[str, Any]:
    """Version 1 knew no time."""
    return {**manifest, "clip": None}


_STEPS: dict[int, Callable[[dict[str, Any]], dict[str, Any]]] = {1: _with_clip}


def upgraded(manifest: dict[str, Any]) -> dict[str, Any]:
    """A manifest of an older version as one of today.

    Raises
    ------
    ValueError
        No version, or one that is newer than this program.
    """
    version = manifest.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version < 1:
        raise ValueError(f"its version is {version!r}, which no version of pliant has written")
    if version > VERSION:
        raise ValueError(
            f"a newer pliant wrote it (format {version}; this pliant reads up to {VERSION}): update pliant"
        )
    for step in range(version, VERSION):
        manifest = _STEPS[step](manifest)
    return {**manifest, "version": VERSION}
