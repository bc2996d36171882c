"""Templates: ready recipes that fit any mesh. Ours stand beside this file; users keep theirs in their own folder."""

from __future__ import annotations

import os
import re
from functools import cache
from pathlib import Path

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip
from pliant.scene.recipe import Recipe, read_recipe
from pliant.scene.recipe_writing import write_recipe
from pliant.scene.stack import Stack

_OURS = Path(__file__).with_name("template_files")
_NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,60}")


def user_folder() -> Path:
    """Where users keep templates: ``PLIANT_TEMPLATES``, or ``.pliant/templates`` in their home folder."""
    return Path(os.environ.get("PLIANT_TEMPLATES") or Path.home() / ".pliant" / "templates")


def templates() -> dict[str, Recipe]:
    """All templates by name: the user's own before ours of the same name.

    Raises
    ------
    UnreadableFile
        One of the user's own is no recipe.
    """
    found = dict(_ours())
    folder = user_folder()
    if folder.is_dir():
        found.update({path.stem: read_recipe(path) for path in sorted(folder.glob("*.toml"))})
    return dict(sorted(found.items()))


def template(name: str) -> Recipe:
    """One template.

    Parameters
    ----------
    name
        As in :func:`templates`.

    Raises
    ------
    InvalidParameter
        There is none of that name.
    """
    own = user_folder() / f"{name}.toml"
    if _NAME.fullmatch(name) and own.is_file():
        return read_recipe(own)
    if name not in _ours():
        raise InvalidParameter(f"there is no template {name!r}; there are: {', '.join(templates())}")
    return _ours()[name]


def save_template(
    source: Stack | Clip, name: str, *, mesh: PolygonMesh | None = None, title: str = "", about: str = ""
) -> Path:
    """Keep a stack or a clip as a template of the user's own, which fits any mesh.

    Positions then go with the bounding box along each of its axes, lengths with its diagonal; angles, factors and
    directions stay. Masks and edits of a surface know its vertices: they fit meshes of the same topology only.

    Parameters
    ----------
    source
        The stack or clip.
    mesh
        What a stack's numbers were made for; None = as they are, for meshes of that size in that place. A clip knows
        its mesh.
    name
        Small letters, digits and hyphens.
    title, about
        What people call it, and what it does.

    Returns
    -------
    Path
        Its file.

    Raises
    ------
    InvalidParameter
        A name of other letters, or a clip whose mesh has a motion of its own.
    """
    if not _NAME.fullmatch(name):
        raise InvalidParameter(f"{name!r} is no name of a template: use small letters, digits and hyphens")
    path = user_folder() / f"{name}.toml"
    made_for = source.mesh if isinstance(source, Clip) else mesh
    write_recipe(source, path, title=title or name, about=about, mesh=made_for)
    return path


@cache
def _ours() -> dict[str, Recipe]:
    return {path.stem: read_recipe(path) for path in sorted(_OURS.glob("*.toml"))}
