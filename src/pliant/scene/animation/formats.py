"""Formats of animations by their endings: clips are written, sequences are read."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from pliant.errors import InvalidParameter, UnreadableFile, UnsupportedFormat, UnwritableFile
from pliant.io.report import LossReport
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip, Progress
from pliant.scene.sequence import MeshSequence

_FORMATS = {
    "pliant.scene.animation.gltf_animation": (".glb", ".gltf"),
    "pliant.scene.animation.usd_animation": (".usd", ".usda", ".usdc"),
    "pliant.scene.animation.pc2": (".pc2",),
    "pliant.scene.animation.mdd": (".mdd",),
    "pliant.scene.animation.pvd": (".pvd",),
    "pliant.scene.animation.alembic_animation": (".abc",),
    "pliant.scene.animation.film": (".mp4", ".gif"),
}
_PICTURES = "pliant.scene.animation.film"


def endings(*, read: bool = False) -> tuple[str, ...]:
    """The endings of files that clips are written to, or sequences read from."""
    return tuple(end for place, ends in _FORMATS.items() for end in ends if not read or place != _PICTURES)


def export_clip(clip: Clip, path: Path | str, *, progress: Progress | None = None, **options: Any) -> LossReport:
    """Write a clip in the format that the ending names; a part of a file is never left.

    Parameters
    ----------
    clip
        The clip.
    path
        Where to.
    progress
        Called with how many frames are done, and how many there are.
    options
        The format's own: ``size``, ``view``, ``up``, ``background``, ``color`` and ``turns`` of films; ``name`` of the
        mesh in glTF and USD.

    Raises
    ------
    UnsupportedFormat
        No format of animations has that ending.
    InvalidParameter
        An option that the format does not know.
    UnwritableFile
        The disk is full, or the place is not writable.
    """
    writer = import_module(_place(Path(path))).write_clip
    _check_options(path, writer, options)
    try:
        report: LossReport = writer(clip, Path(path), progress, **options)
    except OSError as error:  # of what a format keeps beside its file
        raise UnwritableFile(path, error.strerror or str(error)) from error
    return report


def read_sequence(
    path: Path | str, *, mesh: PolygonMesh | None = None, fps: float = 24.0, **options: Any
) -> MeshSequence:
    """The motion that a file holds: a point cache, a series of meshes, or an animated scene.

    Parameters
    ----------
    path
        ``.pc2``, ``.mdd``, ``.pvd``, ``.glb``, ``.gltf``, ``.usd`` or ``.abc``.
    mesh
        The mesh that moves, whose number of points is then checked; None = none is.
    fps
        Frames a second, for files that count frames instead of seconds, and where motion between keys is curved.
    options
        The format's own: ``animation`` of glTF, which of several, by name or number.

    Raises
    ------
    UnreadableFile
        The file is damaged, holds no such motion, or one of another number of points than the mesh.
    UnsupportedFormat
        No format of animations has that ending.
    InvalidParameter
        An option that the format does not know.
    """
    if not 0 < fps < float("inf"):
        raise InvalidParameter(f"fps is {fps}; it must be positive")
    place = _place(Path(path))
    if place == _PICTURES:
        raise UnsupportedFormat(
            f"{path}: a film holds pictures, no points; motions are read from {', '.join(endings(read=True))}"
        )
    reader = import_module(place).read
    _check_options(path, reader, options)
    try:
        found: MeshSequence = reader(Path(path), fps, **options)
    except InvalidParameter as error:
        raise UnreadableFile(path, str(error), "export it again") from error
    if mesh is not None and found.count != len(mesh.points):
        raise UnreadableFile(
            path,
            f"it moves {found.count:,} points; the mesh has {len(mesh.points):,}",
            "name the mesh that it belongs to",
        )
    return found


def _check_options(path: Path | str, function: Any, options: dict[str, Any]) -> None:
    known = list(function.__kwdefaults__ or ())
    for name in options:
        if name not in known:
            raise InvalidParameter(
                f"{Path(path).suffix} knows no option {name!r}; it knows: {', '.join(known) or 'none'}"
            )


def _place(path: Path) -> str:
    for place, ends in _FORMATS.items():
        if path.suffix.lower() in ends:
            return place
    raise UnsupportedFormat(
        f"{path}: no format of animations has the ending {path.suffix!r}; there are {', '.join(endings())}"
    )
