"""Deformation transfer as pages see it: a source with its poses beside the scene's shape, and markers on both.

The scene's shape is the target. What is transferred becomes a layer of shape keys, one a pose: so poses are played,
mixed, saved and exported as everything else is.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.io import meshes
from pliant.mesh import Points, PolygonMesh
from pliant.scene.project import load_project
from pliant.studio.jobs import Job
from pliant.studio.modes.layering import with_layer
from pliant.studio.serving.frames import Frame
from pliant.surface.shape_keys import ShapeKeys
from pliant.surface.transfer import DeformationTransfer

if TYPE_CHECKING:
    from pliant.studio.session import Session

_KEY = "transfer"
_RESTS = re.compile(r"ref|rest|neutral|base", re.IGNORECASE)
_FRAMES = 12  # poses that are taken of a clip
_FEWEST = 3  # markers: fewer do not say how the shapes lie


@dataclass
class Bench:
    """A source, its poses, and the markers.

    Parameters
    ----------
    name
        What the source is called.
    source
        At rest.
    poses
        Its (n, 3) points in each pose, by name.
    markers
        (source, target) vertices that correspond.
    clone
        What has been computed; None where markers have changed since.
    layer
        The layer that came out.
    """

    name: str
    source: PolygonMesh
    poses: dict[str, Points] = field(default_factory=dict)
    markers: list[tuple[int, int]] = field(default_factory=list)
    clone: DeformationTransfer | None = None
    layer: str = ""

    def add_pose(self, name: str, points: Points) -> None:
        """One more pose.

        Raises
        ------
        InvalidParameter
            It is one of another mesh.
        """
        if points.shape != self.source.points.shape:
            raise InvalidParameter(
                f"{name} has {len(points):,} points; the source has {len(self.source.points):,}: a pose is the source "
                "with its vertices elsewhere"
            )
        self.poses[name] = points

    def mark(self, pairs: NDArray[np.int64], target: PolygonMesh) -> None:
        """More markers, checked.

        Raises
        ------
        InvalidParameter
            Vertices that a mesh does not have, or a source vertex that is marked already.
        """
        known = {one for one, _ in self.markers}
        for one, two in pairs.tolist():
            for vertex, (name, mesh) in ((one, ("source", self.source)), (two, ("target", target))):
                if not 0 <= vertex < len(mesh.points):
                    raise InvalidParameter(
                        f"a marker uses {name} vertex {vertex}; the {name} has {len(mesh.points):,}, counted from 0"
                    )
            if one in known:
                raise InvalidParameter(f"source vertex {one} is marked already: remove that marker first")
            known.add(one)
        self.markers = [*self.markers, *((int(one), int(two)) for one, two in pairs.tolist())]
        self.clone = None


def bench_of(session: Session) -> Bench:
    """The source that is loaded.

    Raises
    ------
    InvalidParameter
        None is.
    """
    found: Bench | None = session.beside.get(_KEY)
    if found is None:
        raise InvalidParameter("there is no source yet: load a mesh that has poses")
    return found


def put(session: Session, bench: Bench) -> None:
    """Put a source beside the scene."""
    session.beside[_KEY] = bench


def state_of(session: Session) -> dict[str, Any]:
    """What pages are told of it."""
    bench: Bench | None = session.beside.get(_KEY)
    if bench is None:
        return {"name": None, "points": 0, "poses": [], "markers": [], "ready": False, "layer": ""}
    return {
        "name": bench.name,
        "points": len(bench.source.points),
        "poses": list(bench.poses),
        "markers": [list(pair) for pair in bench.markers],
        "ready": bench.clone is not None,
        "layer": bench.layer,
    }


def tell(session: Session) -> None:
    """Tell all pages."""
    session.broadcast(Frame({"event": "transfer", "state": state_of(session)}))


def read_bench(paths: list[Path]) -> Bench:
    """A source of files: a mesh at rest and its poses, or a project, whose clip is played.

    Raises
    ------
    InvalidParameter
        None of them is a mesh or a project.
    """
    projects = [path for path in paths if path.suffix.lower() == ".pliant"]
    if projects:
        return _of_project(projects[0])
    found = mesh_files(paths)
    if not found:
        raise InvalidParameter(f"{', '.join(path.name for path in paths)}: no mesh that pliant reads")
    rests = [path for path in found if _RESTS.search(path.stem)]
    rest = (rests or found)[0]
    bench = Bench(rest.stem, meshes.read(rest))
    add_poses(bench, [path for path in found if path != rest])
    return bench


def add_poses(bench: Bench, paths: list[Path]) -> None:
    """The poses that mesh files hold."""
    for path in mesh_files(paths):
        bench.add_pose(path.stem, meshes.read(path).points)


def mesh_files(paths: list[Path]) -> list[Path]:
    """Those files that are meshes."""
    endings = tuple(suffix for each in meshes.formats() for suffix in each["suffixes"])
    return [path for path in paths if path.name.lower().removesuffix(".gz").endswith(endings)]


def _of_project(path: Path) -> Bench:
    scene = load_project(path)
    bench = Bench(path.stem, scene.mesh)
    if scene.clip is None or not scene.clip.tracks:
        bench.add_pose(path.stem, scene.deformed().points)
        return bench
    for time in np.linspace(0, scene.clip.duration, _FRAMES):
        bench.add_pose(f"{time:.2f} s", scene.clip.stack_at(float(time))(scene.mesh).points)
    return bench


def read_markers(texts: list[str]) -> NDArray[np.int64]:
    """(k, 2) pairs of one text, or of two that hold a column each: numbers, however they are separated.

    Raises
    ------
    InvalidParameter
        Something else.
    """
    columns = [np.array(_numbers(text), np.int64) for text in texts]
    if len(columns) == 2:
        if len(columns[0]) != len(columns[1]):
            raise InvalidParameter(f"the files hold {len(columns[0])} and {len(columns[1])} markers: they are pairs")
        return np.column_stack(columns)
    if len(columns) != 1 or not len(columns[0]):
        raise InvalidParameter("markers are one file of pairs, or two files of a column each")
    flat = columns[0]
    if len(flat) % 2 and len(flat) == 2 * flat[0] + 1:
        flat = flat[1:]  # their number comes first
    if len(flat) % 2:
        raise InvalidParameter(f"the file holds {len(flat)} numbers: two a marker are needed")
    return np.asarray(flat.reshape(-1, 2))


def _numbers(text: str) -> list[int]:
    try:
        found = json.loads(text)["markers"] if text.lstrip().startswith("{") else None
        if found is not None:
            return [int(vertex) for pair in found for vertex in pair]
        return [int(word) for word in re.split(r"[\s,;]+", text.strip()) if word]
    except (ValueError, TypeError, KeyError) as error:
        raise InvalidParameter("the file holds no markers: pairs of vertex numbers are needed") from error


def compute(session: Session, bench: Bench) -> None:
    """Transfer all poses in the background; a layer of shape keys comes out."""
    target, markers = session.required.mesh, np.array(bench.markers, np.int64).reshape(-1, 2)
    if len(markers) < _FEWEST:
        raise InvalidParameter(f"there are {len(markers)} markers; at least {_FEWEST} are needed, a dozen are good")
    if not bench.poses:
        raise InvalidParameter("the source has no pose yet: add files that hold it with its vertices elsewhere")
    known, poses = bench.clone, dict(bench.poses)

    def work(job: Job) -> tuple[DeformationTransfer, NDArray[np.float64]]:
        def progress(done: int, total: int) -> None:
            if job.stopped.is_set():
                raise InvalidParameter("the transfer was stopped")
            session.submit(session.jobs.tell, job, done / total)

        clone = known or DeformationTransfer(bench.source, target, markers, progress=progress)
        return clone, np.stack([clone.points(points) - target.points for points in poses.values()])

    def done(found: tuple[DeformationTransfer, NDArray[np.float64]]) -> None:
        if session.scene is None or session.scene.mesh is not target or session.beside.get(_KEY) is not bench:
            return
        bench.clone = found[0]
        _commit(session, bench, ShapeKeys(found[1], tuple(poses)))
        tell(session)

    session.jobs.run("Transfer", work, done)


def _commit(session: Session, bench: Bench, keys: ShapeKeys) -> None:
    """The keys as a layer: that which came out before, or a new one; the first pose is shown."""
    scene, stack = session.required, session.required.stack
    keys = keys.moved(np.eye(len(keys.names))[0])
    if bench.layer in stack.names and isinstance(stack[bench.layer].deformer, ShapeKeys):
        stack = stack.replace(bench.layer, deformer=keys)
    else:
        stack, bench.layer = with_layer(stack, "Poses", keys)
    session.drop_drag()
    session.commit(scene.replace(stack=stack), "transfer", bench.layer)
