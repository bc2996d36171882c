"""``pliant skeleton``: the contour-mean skeleton of a mesh, as polylines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.session import Session


def skeleton(
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="A file that holds lines, as .vtp.")],
    contours: Annotated[int, typer.Option(help="How many levels cut the shape.", min=1)] = 30,
    eigenvectors: Annotated[int, typer.Option(help="How many reconstruct the shape.", min=2)] = 10,
    scalar: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Cut across an axis, not along the shape.", show_default=False)
    ] = None,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write the skeleton of a mesh: the means of the loops of its isolines."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.surface.contour_skeletons import contour_skeleton

        shape = read_mesh(session, mesh)
        with session.patience():
            found = contour_skeleton(shape, contours, scalar, eigenvectors=eigenvectors)
        session.say(f"found {len(found.points)} points and {len(found.links)} links")
        report = write_mesh(session, found.as_mesh(), output)
        session.result(
            input=mesh, output=output, points=len(found.points), links=len(found.links), losses=report.losses
        )
