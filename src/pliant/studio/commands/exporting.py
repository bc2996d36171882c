"""Exporting: the deformed mesh, deformations, grids and fields, with what each format could not hold."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from pliant.errors import InvalidParameter, NotDifferentiable
from pliant.field.grids import field_grid
from pliant.field.measures import principal_strains, volume_ratio
from pliant.io import meshes, transforms
from pliant.io.report import LossReport
from pliant.studio.commands.fields import _moved, _room
from pliant.studio.request import Request, command
from pliant.studio.seen.spaces import space_map
from pliant.studio.serving.files import file_stem
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_CELLS = 16


@command("export.mesh", reads=True)
def mesh(session: Session, request: Request) -> Frame:
    """The deformed mesh in a format."""
    suffix = request.text("suffix")
    if suffix not in {ending for each in meshes.formats() if each["written"] for ending in each["suffixes"]}:
        raise InvalidParameter(f"no mesh format has the ending {suffix!r}")
    shape = session.required.deformed()
    return _handed_over(session, suffix, lambda path: meshes.write(shape, path))


@command("export.transform", reads=True)
def transform(session: Session, request: Request) -> Frame:
    """A layer's deformation, or that of all layers, in a format."""
    suffix, name = request.text("suffix"), request.text("layer", "")
    if suffix not in {ending for each in transforms.FORMATS for ending in each.endings}:
        raise InvalidParameter(f"no transform format has the ending {suffix!r}")
    stack = session.required.stack
    deformer = stack[name].deformer if name else space_map(stack)
    ending = suffix if suffix.startswith(".") else f"-{suffix}"
    return _handed_over(session, ending, lambda path: transforms.write_transform(deformer, path))


@command("export.grid", reads=True)
def grid(session: Session, request: Request) -> Frame:
    """The lines of a warped grid as VTK polydata."""
    low, high = _room(session.required.mesh.bounds)
    found = field_grid(_moved(session), (low, high), float((high - low).max()) / _CELLS)
    return _handed_over(session, "-grid.vtp", found.save)


@command("export.surface", reads=True)
def surface(session: Session, request: Request) -> Frame:
    """The deformed surface with the displacement, and the measures of its map, at its vertices."""
    scene = session.required
    shape = scene.deformed()
    attributes = {**shape.vertex_attributes, "displacement": shape.points - scene.mesh.points}
    try:
        between = space_map(scene.stack)
        attributes["volume ratio"] = volume_ratio(between, scene.mesh)
        attributes["strain"] = np.abs(principal_strains(between, scene.mesh)).max(axis=1)
    except NotDifferentiable:
        pass  # surface editing has no Jacobian: the displacement is all there is
    full = shape.replace(vertex_attributes=attributes)
    return _handed_over(session, "-field.vtp", lambda path: meshes.write(full, path))


def _handed_over(session: Session, ending: str, write: Callable[[Path], LossReport]) -> Frame:
    """Files written for a page to take, with their report. Their names are made here, not taken from a page."""
    stem = file_stem(session.name)
    with tempfile.TemporaryDirectory(prefix="pliant-export-") as name:
        folder = Path(name)
        report = write(folder / f"{stem}{ending}")
        files = sorted(path for path in folder.iterdir() if path.is_file())
        arrays = {path.name: np.frombuffer(path.read_bytes(), np.uint8) for path in files}
    head = {"files": list(arrays), "losses": list(report.losses), "notes": list(report.notes)}
    return Frame(head, arrays)
