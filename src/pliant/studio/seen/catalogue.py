"""What there is to choose from: deformers, formats, quantities, examples, recent files."""

from __future__ import annotations

from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pliant._version import __version__
from pliant.scene import easing
from pliant.scene.kinds import Kind, all_kinds
from pliant.studio.examples.sample_scenes import SCENES
from pliant.studio.examples.samples import SAMPLES
from pliant.studio.seen.quantities import QUANTITIES
from pliant.studio.seen.titles import titled
from pliant.studio.serving.files import CHUNK, MOST_BYTES

if TYPE_CHECKING:
    from pliant.studio.session import Session

LATTICES = ("bspline-ffd", "bezier-ffd", "clamped-ffd", "bezier-patch-ffd", "extended-ffd")

_HANDLES = {"linear": (1 / 3, 1 / 3, 2 / 3, 2 / 3), "smooth": (1 / 3, 0.0, 2 / 3, 1.0), **easing.CURVES}


def catalogue(session: Session) -> dict[str, Any]:
    """What a page can offer."""
    return {**_lasting(), "recent": _recent(session), "recoverable": _recoverable(session)}


@cache
def _lasting() -> dict[str, Any]:
    from pliant.io import meshes, transforms

    written = [each for each in meshes.formats() if each["written"]]
    return {
        "version": __version__,
        "kinds": [_kind(kind) for kind in all_kinds().values() if kind.makers],
        "meshes": [{"name": each["name"], "suffixes": list(each["suffixes"])} for each in written],
        "readable": sorted({suffix for each in meshes.formats() for suffix in each["suffixes"]}),
        "transforms": [{"name": each.name, "suffixes": list(each.endings)} for each in transforms.FORMATS],
        "quantities": list(QUANTITIES),
        "examples": _examples(),
        "easings": [{"name": name, "handles": _HANDLES.get(name)} for name in easing.NAMES],
        "caps": {"upload": MOST_BYTES, "chunk": CHUNK},
    }


def _examples() -> list[dict[str, Any]]:
    there = {name: each for name, each in SCENES.items() if each.there()}
    return [{"name": name, "title": each.title, "points": each.points} for name, each in (SAMPLES | there).items()]


def _kind(kind: Kind) -> dict[str, Any]:
    group = "lattice" if kind.name in LATTICES else "shape" if hasattr(kind.cls, "parameters") else "field"
    makers = {name: [asdict(field) for field in fields] for name, fields in kind.makers.items()}
    return {"name": kind.name, "title": titled(kind.name), "summary": kind.summary, "group": group, "makers": makers}


def _recent(session: Session) -> list[str]:
    """Recent files below the studio's folder, as seen from there."""
    if session.autosave is None or session.root is None:
        return []
    found = []
    for name in session.autosave.recent():
        path = Path(name)
        if path.is_relative_to(session.root) and path.is_file():
            found.append(path.relative_to(session.root).as_posix())
    return found


def _recoverable(session: Session) -> list[dict[str, str]]:
    return [] if session.autosave is None else session.autosave.recoverable()
