"""``pliant smooth``: a mesh without its roughness."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.region import FORMS, vertices
from pliant.cli.session import Session


class Way(StrEnum):
    """How to smooth."""

    implicit = "implicit"
    explicit = "explicit"
    taubin = "taubin"


def smooth(
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the smooth mesh.")],
    iterations: Annotated[int, typer.Option("--iterations", "-n", help="How often.", min=0)] = 5,
    method: Annotated[Way, typer.Option(help="Stable at any strength; simple; or keeping the volume.")] = Way.implicit,
    strength: Annotated[float, typer.Option(help="Of each time; at most 1 but for implicit.", min=1e-9)] = 0.5,
    roi: Annotated[
        str | None, typer.Option("--roi", metavar="REGION", help=f"What may move: {FORMS}.", show_default=False)
    ] = None,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Smooth a mesh."""
    with Session(json=json, quiet=quiet) as session:
        import numpy as np

        from pliant.surface.smoothing import smooth as smoothed

        shape = read_mesh(session, mesh)
        within = None if roi is None else vertices(roi, shape, "--roi")
        with session.patience():
            result = smoothed(shape, iterations, method=method.value, strength=strength, within=within)
        length = np.linalg.norm(result.points - shape.points, axis=1)
        session.say(f"smoothed: points moved by {float(length.max(initial=0.0)):.4g} at most")
        report = write_mesh(session, result, output, strict=strict)
        session.result(
            input=mesh,
            output=output,
            points=len(shape.points),
            displacement={"largest": float(length.max(initial=0.0))},
            losses=report.losses,
            notes=report.notes,
        )
