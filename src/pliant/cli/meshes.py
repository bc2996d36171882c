"""How commands read and write meshes: what was read is said, and what a format does not hold."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.io.report import LossReport
    from pliant.mesh import PolygonMesh


def read_mesh(session: Session, path: Path) -> PolygonMesh:
    """Read a mesh, and say how large it is."""
    from pliant.io.meshes import read

    mesh = read(path)
    session.say(f"read {path}: {len(mesh.points):,} points, {len(mesh.faces):,} faces")
    return mesh


def write_mesh(session: Session, mesh: PolygonMesh, output: Path, *, strict: bool = False) -> LossReport:
    """Write a mesh, and say what its format does not hold."""
    from pliant.io.meshes import write

    report = write(mesh, output, strict=strict)
    session.tell_losses(report)
    session.say(f"wrote {output}")
    return report
