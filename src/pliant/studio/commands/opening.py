"""Opening: examples, uploads, files of the studio's folder, unsaved work; saving and closing."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from pliant.errors import InvalidMesh, InvalidParameter
from pliant.io import meshes, models, transforms
from pliant.io.files import read_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.project import load_project, save_project
from pliant.scene.scene import Scene
from pliant.studio.examples.sample_scenes import SCENES
from pliant.studio.examples.samples import sample
from pliant.studio.modes.faces import photograph_of
from pliant.studio.modes.shape_models import model_scene
from pliant.studio.request import Later, Request, command
from pliant.studio.seen.stage import Stage
from pliant.studio.serving.files import CHUNK, inside
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

PROJECT = ".pliant"
MOST_POINTS = 8_000_000
_MOST_ENTRIES = 2000


@command("upload.begin")
def begin_upload(session: Session, request: Request) -> Frame:
    """Announce files."""
    return Frame({"upload": session.uploads.begin(request.several("files"))})


@command("upload.chunk")
def chunk(session: Session, request: Request) -> None:
    """A piece of a file."""
    data = request.array("bytes")
    if data.nbytes > CHUNK:
        raise InvalidParameter(f"a piece of a file may have {CHUNK:,} bytes; this one has {data.nbytes:,}")
    session.uploads.write(request.text("upload"), request.integer("file"), data)


@command("open.upload")
def open_upload(session: Session, request: Request) -> Frame | Later:
    """A mesh, a model or a project of uploaded files; transforms and photographs are left for the page to ask about."""
    found = session.uploads.get(request.text("upload"))
    if not found.complete:
        raise InvalidParameter("the files have not come whole: send them again")
    paths = [found.path(at) for at in range(len(found.names))]
    chosen = main_file(paths)
    if photograph_of([chosen]):
        return Frame({"photograph": chosen.name})
    if _is_transform(chosen):
        if session.scene is None:
            raise InvalidParameter(f"{chosen.name} is a deformation: open a mesh first, then drop it again")
        return Frame({"transform": chosen.name})
    return _open(session, chosen, chosen.stem)


@command("open.path")
def open_path(session: Session, request: Request) -> Later:
    """A mesh or a project of the studio's folder."""
    path = inside(session.root, request.text("path"))
    if session.autosave is not None:
        session.autosave.remember(path)
    return _open(session, path, path.stem)


@command("open.example")
def open_example(session: Session, request: Request) -> Later | None:
    """A shape or a scene of the start page."""
    name = request.text("name")
    if name not in SCENES:
        return Later(lambda: Stage(Scene(sample(name))), lambda stage: session.begin(stage, name.capitalize()))
    found = SCENES[name]
    work = lambda _: Stage(found.make())  # noqa: E731
    session.jobs.run(found.title, work, lambda stage: enter(session, stage, found.title, found.mode))
    return None


@command("open.recover")
def recover(session: Session, request: Request) -> Later:
    """Work that was not saved before its studio ended."""
    autosave, name = session.autosave, request.text("name")
    if autosave is None:
        raise InvalidParameter("this studio keeps no unsaved work")

    def done(stage: Stage) -> None:
        session.begin(stage, "Recovered", "recover")
        session.saved = -1
        autosave.keep(stage.given, "Recovered")
        autosave.recovered(name)
        session.tell_scene()

    return Later(lambda: Stage(load_project(autosave.place(name))), done)


@command("scene.close")
def close(session: Session, request: Request) -> None:
    """Back to the start page."""
    session.close()


@command("project.save")
def save(session: Session, request: Request) -> Later:
    """The scene as a project file, for the page to hand over."""
    scene, revision, name = session.required, session.revision, f"{session.name or 'scene'}{PROJECT}"

    def work() -> bytes:
        with tempfile.TemporaryDirectory(prefix="pliant-save-") as folder:
            save_project(scene, Path(folder) / name)
            return read_bytes(Path(folder) / name)

    def done(data: bytes) -> Frame:
        if session.revision == revision:  # else there is something unsaved again
            session.saved = revision
            if session.autosave is not None:
                session.autosave.forget()
        session.tell_scene()
        return Frame({"name": name}, {"file": np.frombuffer(data, np.uint8)})

    return Later(work, done)


@command("folder.list", reads=True)
def listing(session: Session, request: Request) -> Frame:
    """Folders, and files that can be opened, of a folder below the studio's."""
    folder = inside(session.root, request.text("folder", ""))
    if not folder.is_dir():
        raise InvalidParameter("this folder is gone")
    endings = (PROJECT, ".h5", ".h5.json", *(suffix for each in meshes.formats() for suffix in each["suffixes"]))
    entries = sorted((each for each in folder.iterdir() if not each.name.startswith(".")), key=lambda each: each.name)
    folders = [each.name for each in entries if each.is_dir()][:_MOST_ENTRIES]
    files = [each.name for each in entries if each.is_file() and each.name.lower().endswith(endings)]
    return Frame({"folders": folders, "files": files[:_MOST_ENTRIES]})


def enter(session: Session, stage: Stage, name: str, mode: str) -> None:
    """Show a scene in the mode that it is for; empty = in the one that each page is in."""
    session.begin(stage, name)
    if mode:
        session.broadcast(Frame({"event": "enter", "mode": mode}))


def read_scene(path: Path) -> Scene:
    """The scene of a project, of a shape model, or of a mesh.

    Raises
    ------
    InvalidMesh
        No points, or more than a browser can draw.
    """
    if path.suffix.lower() == PROJECT:
        scene = load_project(path)
    else:
        scene = model_scene(models.read_model(path)) if holds_model(path) else Scene(meshes.read(path))
    _require_drawable(scene.mesh, path.name)
    return scene


def main_file(paths: list[Path]) -> Path:
    """The file that others belong to: a project, else a mesh, a shape model, a transform, a photograph.

    Raises
    ------
    InvalidParameter
        None of them is any of these.
    """
    endings = [suffix for each in meshes.formats() for suffix in each["suffixes"]]
    for wanted in ([PROJECT], endings):
        for path in paths:
            if path.name.lower().removesuffix(".gz").endswith(tuple(wanted)) and not _is_transform(path):
                return path
    for holds in (holds_model, _is_transform):
        for path in paths:
            if holds(path):
                return path
    photograph = photograph_of(paths)
    if photograph is not None:
        return photograph
    names = ", ".join(path.name for path in paths)
    raise InvalidParameter(f"{names}: neither a mesh, a model, a project, a deformation nor a photograph")


def _open(session: Session, path: Path, name: str) -> Later:
    def work() -> tuple[Stage, str]:
        return Stage(read_scene(path)), "model" if holds_model(path) else ""

    def done(found: tuple[Stage, str]) -> Frame:
        stage, mode = found
        enter(session, stage, name, mode)
        return Frame({"notes": []})

    return Later(work, done)


def holds_model(path: Path) -> bool:
    """Whether a file is a shape model, by its content where its ending may be another's too."""
    return path.is_file() and path.name.lower().endswith(models.ENDINGS) and models.is_model(path)


def _is_transform(path: Path) -> bool:
    """By its content where its ending may be a mesh's too."""
    if not path.is_file() or holds_model(path):
        return False
    with path.open("rb") as stream:
        head = stream.read(1 << 16)
    found = transforms.transform_format(path, head)
    return found is not None and (path.name.lower().endswith(found.endings))


def _require_drawable(mesh: PolygonMesh, name: str) -> None:
    if not len(mesh.points):
        raise InvalidMesh(f"{name} has no points: there is nothing to show")
    if len(mesh.points) > MOST_POINTS:
        raise InvalidMesh(f"{name} has {len(mesh.points):,} points; the studio shows {MOST_POINTS:,} at most")
