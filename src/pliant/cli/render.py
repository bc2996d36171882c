"""``pliant render``: a picture of a mesh, its deformation and what deforms it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.choice import Choice, half_turn
from pliant.cli.deformer_options import STEPS
from pliant.cli.meshes import read_mesh
from pliant.cli.session import Session


def render(
    context: typer.Context,
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="PNG", help="Where to write the picture.")],
    ffd: opt.FFDOption = None,
    placement: opt.PlacementOption = opt.Placement.physical,
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    origin: opt.OriginOption = None,
    lattice: opt.LatticeOption = None,
    margin: opt.MarginOption = 0.0,
    move: opt.MoveOption = None,
    inverse: opt.InverseOption = False,
    mesh_space: opt.MeshSpaceOption = opt.MeshSpace.as_is,
    show: Annotated[
        str, typer.Option(metavar="LIST", help="Any of mesh, edges, lattice, grid, arrows, separated by commas.")
    ] = "mesh,lattice",
    color: Annotated[
        str | None, typer.Option(help="texture, displacement, x, y, z, det (of the Jacobian), or an attribute.")
    ] = None,
    view: Annotated[str, typer.Option(help="iso, front, back, left, right, top or bottom.")] = "iso",
    up: Annotated[str, typer.Option(help="The axis that points up: z or y.")] = "z",
    background: Annotated[str, typer.Option(help="light, dark or transparent.")] = "light",
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Draw a mesh and what deforms it.

    Needs the extra 'render'. A mesh in LPS is drawn in RAS, the space of the transform.
    """
    steps = context.meta[STEPS]
    choice = Choice(ffd, placement, variant, edge, origin, lattice, margin, tuple(move or ()), inverse, steps=steps)
    with Session(json=json, quiet=quiet) as session:
        from pliant.rendering.pictures import render as draw

        shape = read_mesh(session, mesh)
        if mesh_space is opt.MeshSpace.lps:
            shape = half_turn()(shape)
        deformer = choice.deformer(shape)
        words = tuple(word.strip() for word in show.split(",") if word.strip())
        paint = "volume ratio" if color == "det" else color
        draw(shape, deformer, output, show=words, color=paint, view=view, up=up, background=background)
        session.say(f"wrote {output}")
        session.result(input=mesh, output=output, shown=words)
