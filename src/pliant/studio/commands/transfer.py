"""Deformation transfer: a source and its poses, markers in pairs, computing, and playing the poses."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.io import meshes
from pliant.mesh import Points
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.studio.dragging import Dragging, begin, cancel, commit, ongoing
from pliant.studio.examples.transfer_sample import arm, posed_bar
from pliant.studio.modes import transferring
from pliant.studio.request import Client, Request, command
from pliant.studio.seen.drawn import DrawnMesh
from pliant.studio.serving.files import Upload
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session
from pliant.surface.shape_keys import ShapeKeys


class Playing(Dragging):
    """Poses are mixed by their weights."""

    def __init__(self, session: Session, client: Client, layer: str) -> None:
        super().__init__(session, client, layer, "play")
        self._keys = _keys(session, layer)
        self._drag = session.shown.binding.drag_layer(layer)

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        weights = request.numbers("weights", len(self._keys.names))
        touched = self._drag.update(weights)
        return touched, self._drag.points, _source_in(self._session, dict(zip(self._keys.names, weights, strict=True)))

    @property
    def stack(self) -> Stack:
        return self._drag.stack


@command("transfer.state")
def state(session: Session, request: Request) -> Frame:
    """What is beside the scene."""
    return Frame({"state": transferring.state_of(session)})


@command("transfer.source")
def source(session: Session, request: Request) -> None:
    """A source of uploaded files; markers of another are forgotten."""
    session.required  # noqa: B018 -- without a shape there is no target
    transferring.put(session, transferring.read_bench(_paths(session, request)))
    transferring.tell(session)


@command("transfer.poses")
def poses(session: Session, request: Request) -> None:
    """More poses, of uploaded files."""
    bench, paths = transferring.bench_of(session), _paths(session, request)
    if not transferring.mesh_files(paths):
        raise InvalidParameter(f"{', '.join(path.name for path in paths)}: no mesh that pliant reads")
    transferring.add_poses(bench, paths)
    transferring.tell(session)


@command("transfer.drop_pose")
def drop_pose(session: Session, request: Request) -> None:
    """Without a pose."""
    bench, name = transferring.bench_of(session), request.text("name")
    if name not in bench.poses:
        raise InvalidParameter(f"there is no pose {name!r}")
    del bench.poses[name]
    transferring.tell(session)


@command("transfer.example")
def example(session: Session, request: Request) -> None:
    """A bumpy arm, and a bar that has poses for it, with markers on both."""
    target = arm()
    session.begin(Scene(target), "Arm")
    transferring.put(session, posed_bar(target))
    transferring.tell(session)


@command("transfer.mesh")
def mesh(session: Session, request: Request) -> Frame:
    """The source, for drawing: at rest, or in a pose."""
    bench = transferring.bench_of(session)
    points, name = bench.source.points, request.text("pose", "")
    if name:
        if name not in bench.poses:
            raise InvalidParameter(f"there is no pose {name!r}")
        points = bench.poses[name]
    drawn = DrawnMesh(bench.source)
    arrays: dict[str, NDArray[Any]] = {
        "positions": points.astype(np.float32),
        "normals": drawn.normals(points),
        "triangles": drawn.triangles.astype(np.uint32),
    }
    return Frame({"name": bench.name}, arrays)


@command("transfer.mark")
def mark(session: Session, request: Request) -> None:
    """One more pair."""
    pair = np.array([[request.integer("source"), request.integer("target")]], np.int64)
    transferring.bench_of(session).mark(pair, session.required.mesh)
    transferring.tell(session)


@command("transfer.unmark")
def unmark(session: Session, request: Request) -> None:
    """Without a pair; without all of them where none is named."""
    bench, at = transferring.bench_of(session), request.integer("index", -1)
    if at >= len(bench.markers):
        raise InvalidParameter(f"there is no marker {at}; there are {len(bench.markers)}")
    bench.markers = [] if at < 0 else [*bench.markers[:at], *bench.markers[at + 1 :]]
    bench.clone = None
    transferring.tell(session)


@command("transfer.load")
def load(session: Session, request: Request) -> None:
    """The markers of a file, in place of those that there are."""
    bench, texts = transferring.bench_of(session), request.several("texts")
    if not all(isinstance(text, str) for text in texts):
        raise InvalidParameter("markers are read from texts")
    pairs, before = transferring.read_markers(texts), bench.markers
    bench.markers = []
    try:
        bench.mark(pairs, session.required.mesh)
    except InvalidParameter:
        bench.markers = before
        raise
    transferring.tell(session)


@command("transfer.compute")
def compute(session: Session, request: Request) -> None:
    """Find what belongs together, and put the scene's shape into all poses: in the background."""
    transferring.compute(session, transferring.bench_of(session))


@command("transfer.keys")
def keys(session: Session, request: Request) -> Frame:
    """The poses of a layer, and how much there is of each; the source in the same mixture."""
    found = _keys(session, request.text("layer"))
    weights = found.controls.tolist()
    head = {"names": list(found.names), "weights": weights}
    return Frame(head, _source_in(session, dict(zip(found.names, weights, strict=True))))


@command("transfer.begin")
def play(session: Session, request: Request) -> None:
    """Begin to mix poses."""
    begin(Playing(session, request.client, request.text("layer")), session)


@command("transfer.move")
def move(session: Session, request: Request) -> Frame:
    """Other weights."""
    return ongoing(session, request).preview(request)


command("transfer.commit")(commit)
command("transfer.cancel")(cancel)


@command("transfer.export", reads=True)
def export(session: Session, request: Request) -> Frame:
    """The scene's shape in each pose of a layer, a file each."""
    scene, suffix, name = session.required, request.text("suffix"), request.text("layer")
    if suffix not in {ending for each in meshes.formats() if each["written"] for ending in each["suffixes"]}:
        raise InvalidParameter(f"no mesh format has the ending {suffix!r}")
    found = _keys(session, name)
    losses: list[str] = []
    with tempfile.TemporaryDirectory(prefix="pliant-export-") as place:
        folder = Path(place)
        for at, (pose, weights) in enumerate(zip(found.names, np.eye(len(found.names)), strict=True)):
            stack = scene.stack.replace(name, deformer=found.moved(weights))
            stem = re.sub(r"[^\w.-]+", "-", f"{session.name}-{at + 1}-{pose}").strip("-.")
            losses += meshes.write(stack(scene.mesh), folder / f"{stem}{suffix}").losses
        files = sorted(path for path in folder.iterdir() if path.is_file())
        arrays = {path.name: np.frombuffer(path.read_bytes(), np.uint8) for path in files}
    return Frame({"files": list(arrays), "losses": sorted(set(losses)), "notes": []}, arrays)


def _paths(session: Session, request: Request) -> list[Path]:
    found: Upload = session.uploads.get(request.text("upload"))
    if not found.complete:
        raise InvalidParameter("the files have not come whole: send them again")
    return [found.path(at) for at in range(len(found.names))]


def _keys(session: Session, layer: str) -> ShapeKeys:
    found = session.required.stack[layer].deformer
    if not isinstance(found, ShapeKeys):
        raise InvalidParameter(f"layer {layer!r} has no poses: choose one of shape keys")
    return found


def _source_in(session: Session, weights: dict[str, float]) -> dict[str, NDArray[Any]]:
    """The source in the same mixture of its poses, where it is there."""
    bench: transferring.Bench | None = session.beside.get("transfer")
    if bench is None or not bench.poses:
        return {}
    rest = bench.source.points
    shares = {name: weight for name, weight in weights.items() if weight and name in bench.poses}
    points = rest + sum((weight * (bench.poses[name] - rest) for name, weight in shares.items()), np.zeros_like(rest))
    normals = DrawnMesh(bench.source).normals(points)
    return {"source": points.astype(np.float32), "source_normals": normals}
