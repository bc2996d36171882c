"""PVD: a list of times and files, one VTP each, which ParaView plays."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.io.files import read_bytes, write_bytes
from pliant.io.meshes import read as read_mesh
from pliant.io.meshes import write as write_mesh
from pliant.io.report import LossReport
from pliant.scene.clip import Clip, Progress
from pliant.scene.places import stored_place
from pliant.scene.sequence import MeshSequence


def write_clip(clip: Clip, path: Path, progress: Progress | None) -> LossReport:
    """A folder of meshes beside the file, and at the end the file that lists them."""
    folder = path.with_name(f"{path.stem}_frames")
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="1.0">', "  <Collection>"]
    report: LossReport | None = None
    mesh = clip.mesh.replace(carrier=None, normals=None)
    for i, frame in enumerate(clip.frames(progress)):
        name = f"{folder.name}/{path.stem}_{i:05d}.vtp"
        report = write_mesh(mesh.with_points(frame.points), path.parent / name)
        lines.append(f'    <DataSet timestep="{frame.time!r}" part="0" file="{_escaped(name)}"/>')
    write_bytes(path, "\n".join([*lines, "  </Collection>", "</VTKFile>", ""]).encode())
    assert report is not None
    return LossReport(path, "PVD", report.losses, report.notes)


def read(path: Path, _fps: float) -> MeshSequence:
    """The points of the listed meshes.

    Raises
    ------
    UnreadableFile
        No list of files, or meshes of different numbers of points.
    """
    found: list[tuple[float, str]] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda tag, values: _collect(found, tag, values)
    parser.EntityDeclHandler = lambda *_: _refuse()
    try:
        parser.Parse(read_bytes(path), True)
        places = [(time, stored_place(file)) for time, file in found]
    except (expat.ExpatError, KeyError, ValueError, InvalidParameter) as error:
        raise UnreadableFile(path, f"it is no list of files: {error}", "export it again") from error
    if not places:
        raise UnreadableFile(path, "it lists no files")
    frames = [read_mesh(path.parent / place).points for _, place in places]
    sizes = sorted({len(points) for points in frames})
    if len(sizes) > 1:
        raise UnreadableFile(path, f"its meshes have {sizes[0]:,} to {sizes[-1]:,} points: they are not one that moves")
    return MeshSequence(np.stack(frames), [time for time, _ in places])


def _collect(found: list[tuple[float, str]], tag: str, values: dict[str, Any]) -> None:
    if tag == "DataSet":
        found.append((float(values["timestep"]), values["file"]))


def _refuse() -> None:
    raise ValueError("it declares entities")


def _escaped(name: str) -> str:
    return name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
