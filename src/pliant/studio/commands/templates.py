"""Templates: a gallery of ready motions on the scene's own mesh, put on it, and kept."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.scene.template_library import save_template, template, templates, user_folder
from pliant.studio.modes.posing import clip_of
from pliant.studio.modes.templating import begun_anew, on_top
from pliant.studio.request import Request, command
from pliant.studio.seen.previews import Small, preview
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_SMALL = "small mesh"
_STRONGEST = 4.0


@command("templates.list", reads=True)
def listing(session: Session, request: Request) -> Frame:
    """All templates: what they are called, what they do, how long they last."""
    folder = user_folder()
    found = [
        {
            "name": name,
            "title": recipe.title,
            "about": recipe.about,
            "moves": recipe.moves,
            "duration": float(recipe.document.get("duration", 1.0)),
            "ending": recipe.document.get("ending", "once"),
            "own": (folder / f"{name}.toml").is_file(),
        }
        for name, recipe in templates().items()
    ]
    return Frame({"templates": found})


@command("templates.preview", reads=True)
def show(session: Session, request: Request) -> Frame:
    """Some moments of a template on a mesh of few vertices, which is the scene's."""
    small = _small(session)
    shape = small.at(session.required.mesh.points if request.truth("replace") else session.shown.binding.result)
    found = preview(template(request.text("name")), shape, _intensity(request), request.text("up", "z"))
    arrays: dict[str, NDArray[Any]] = {
        "positions": found.points.reshape(-1),
        "normals": found.normals.reshape(-1),
        "triangles": small.mesh.triangles.astype(np.uint32).reshape(-1),
    }
    return Frame({"moments": len(found.points), "period": found.period}, arrays)


@command("templates.apply")
def apply(session: Session, request: Request) -> Frame:
    """Put a template on the scene: instead of its layers, or above them from a moment on."""
    recipe, scene = template(request.text("name")), session.required
    intensity, up = _intensity(request), request.text("up", "z")
    duration = request.number("duration") if "duration" in request.values else None
    session.drop_drag()
    if request.truth("replace"):
        made = begun_anew(scene, recipe, intensity, duration, up)
    else:
        shape = scene.mesh.with_points(session.shown.binding.result)
        made = on_top(scene, shape, recipe, intensity, duration, up, request.number("start", 0.0))
    session.commit(made, "template", recipe.title)
    return Frame({"layer": made.stack.names[-1]})


@command("templates.save")
def keep(session: Session, request: Request) -> Frame:
    """Keep the scene's layers and keys as a template of one's own."""
    scene = session.required
    if not len(scene.stack):
        raise InvalidParameter("nothing deforms this shape yet: add a layer before it is kept as a template")
    clip = clip_of(scene)
    source = clip if clip.tracks else scene.stack
    title, about = request.text("title", ""), request.text("about", "")
    path = save_template(source, request.text("name"), mesh=scene.mesh, title=title, about=about)
    return Frame({"name": path.stem})


def _intensity(request: Request) -> float:
    value = request.number("intensity", 1.0)
    if not -_STRONGEST <= value <= _STRONGEST:
        raise InvalidParameter(f"the intensity is {value:g}; it may be from {-_STRONGEST:g} to {_STRONGEST:g}")
    return value


def _small(session: Session) -> Small:
    """The scene's mesh with few vertices, made once."""
    found: Small | None = session.beside.get(_SMALL)
    if found is None:
        found = session.beside[_SMALL] = Small.of(session.required.mesh)
    return found
