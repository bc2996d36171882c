"""Parts from CAD on the command line: what ``deform``, ``apply`` and ``info`` do where the file is STEP or IGES."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli.meshes import write_mesh
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.cad import Part
    from pliant.deformer import SpaceDeformer
    from pliant.mesh import PolygonMesh
    from pliant.scene.stack import Stack

ENDINGS = (".step", ".stp", ".iges", ".igs")

ToleranceOption = Annotated[
    float | None,
    typer.Option(metavar="MM", show_default=False, help="Parts (.step, .iges): how exact new surfaces are."),
]


def is_part(path: Path) -> bool:
    """Whether a file's name is that of a part."""
    return path.suffix.lower() in ENDINGS


def deform_part(
    session: Session,
    path: Path,
    output: Path,
    chosen: Callable[[PolygonMesh], SpaceDeformer | Stack],
    tolerance: float | None,
    *,
    strict: bool = False,
) -> None:
    """Read a part, deform its surfaces, and write a part, or the triangles of one."""
    from pliant.cad import read, write

    part = read(path)
    session.say(f"read {path}: {part}")
    with session.patience():
        moved = part.deformed(chosen(part.mesh()), tolerance=tolerance)
    if is_part(output):
        report = write(moved, output, strict=strict)
        session.tell_losses(report)
        session.say(f"wrote {output}: {moved}")
    else:
        report = write_mesh(session, moved.mesh(), output, strict=strict)
    session.result(
        input=path, output=output, volume=moved.volume, gap=moved.gap, valid=moved.valid, losses=report.losses
    )


def facts_of_part(part: Part) -> dict[str, Any]:
    """What there is to tell of a part."""
    from pliant.cad.kernel import parts_of

    low, high = part.mesh().bounds
    return {
        "kind": "part",
        **{f"{kind}s": len(parts_of(part.shape, kind)) for kind in ("solid", "face", "edge")},
        "lowest": low.tolist(),
        "highest": high.tolist(),
        "unit": "mm",
        "volume": part.volume,
        "smooth_edges": int((part.kinks < 1e-3).sum()),
        "gap": part.gap,
        "valid": part.valid,
        "names": [label.name for label in part.labels if label.name],
        "unkept": list(part.unkept),
    }
