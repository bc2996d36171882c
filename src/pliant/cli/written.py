"""How a command that made a mesh ends: it is written, and losses are told."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.io.report import LossReport
    from pliant.mesh import PolygonMesh


def write_mesh(session: Session, mesh: PolygonMesh, output: Path, *, strict: bool = False) -> LossReport:
    """Write a mesh, and say what its format does not hold."""
    from pliant.io.meshes import write

    report = write(mesh, output, strict=strict)
    for loss in report.losses:
        session.warn(f"{output} does not hold: {loss}")
    for note in report.notes:
        session.say(f"note: {note}")
    session.say(f"wrote {output}")
    return report
