"""``pliant deform``: a mesh in, the deformed mesh out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pliant.cli import free_lattices as free
from pliant.cli import options as opt
from pliant.cli.cage import CageOption, Coordinates, CoordinatesOption, PosedOption, cage_choice
from pliant.cli.choice import Choice
from pliant.cli.deformer_options import STEPS
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.part import ToleranceOption, deform_part, is_part
from pliant.cli.pieces import deform_in_pieces
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.mesh import PolygonMesh


def deform(
    context: typer.Context,
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the deformed mesh.")],
    ffd: opt.FFDOption = None,
    placement: opt.PlacementOption = opt.Placement.physical,
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    origin: opt.OriginOption = None,
    lattice: opt.LatticeOption = None,
    dirichlet: free.DirichletOption = None,
    sites_to: free.SitesToOption = None,
    cylinder: free.CylinderOption = None,
    prism: free.PrismOption = None,
    sphere: free.SphereOption = None,
    cage: CageOption = None,
    posed: PosedOption = None,
    coordinates: CoordinatesOption = Coordinates.mean_value,
    margin: opt.MarginOption = 0.0,
    move: opt.MoveOption = None,
    inverse: opt.InverseOption = False,
    mesh_space: opt.MeshSpaceOption = opt.MeshSpace.as_is,
    tolerance: ToleranceOption = None,
    stream: opt.StreamOption = False,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Deform a mesh.

    Give a transform file, a new lattice whose control points you move, a cage and the same cage posed, or deformations
    such as --twist, several in turn. Polygons, texture coordinates, groups and materials stay as they are; stored
    normals follow. A part from CAD stays one: its surfaces become B-splines.
    """
    steps = context.meta[STEPS]
    tool = free.free_lattice(dirichlet, sites_to, cylinder, prism, sphere)
    choice = Choice(
        ffd,
        placement,
        variant,
        edge,
        origin,
        lattice,
        margin,
        tuple(move or ()),
        inverse,
        mesh_space,
        steps,
        tool,
        cage_choice(cage, posed, coordinates),
    )
    with Session(json=json, quiet=quiet) as session:
        if is_part(mesh):
            deform_part(session, mesh, output, choice.required, tolerance, strict=strict)
        elif stream:
            deform_in_pieces(session, mesh, output, choice.required)
        else:
            deform_file(session, mesh, output, choice, strict=strict)


def deform_file(session: Session, path: Path, output: Path, choice: Choice, *, strict: bool = False) -> PolygonMesh:
    """Read, deform, write, and report; the deformed mesh is returned."""
    import numpy as np

    mesh = read_mesh(session, path)
    deformer = choice.required(mesh)
    with session.patience():
        moved = deformer(mesh)
    length = np.linalg.norm(moved.points - mesh.points, axis=1)
    largest, mean = float(length.max(initial=0.0)), float(length.mean()) if len(length) else 0.0
    session.say(f"deformed: points moved by {mean:.4g} on average, {largest:.4g} at most")
    report = write_mesh(session, moved, output, strict=strict)
    session.result(
        input=path,
        output=output,
        points=len(mesh.points),
        displacement={"mean": mean, "largest": largest},
        losses=report.losses,
        notes=report.notes,
    )
    return moved
