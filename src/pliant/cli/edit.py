"""``pliant edit``: a mesh is edited through its own geometry."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.region import FORMS, vertices
from pliant.cli.session import Session

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from pliant.surface.editing import SurfaceDeformer


class Method(StrEnum):
    """Surface deformers."""

    arap = "arap"
    laplacian = "laplacian"
    skeleton = "skeleton"


def edit(
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the edited mesh.")],
    roi: Annotated[str, typer.Option("--roi", metavar="REGION", help=f"What may move: {FORMS}.")],
    handle: Annotated[str, typer.Option("--handle", metavar="REGION", help="What is moved, a part of --roi.")],
    move: Annotated[str, typer.Option("--move", metavar="DX,DY,DZ", help="How far the handle is moved.")],
    method: Annotated[Method, typer.Option(help="Rigid cells, differential coordinates, or a skeleton.")] = Method.arap,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Edit a part of a mesh: move a handle, and the surface follows.

    What lies outside --roi stays as it is, to the last bit.
    """
    with Session(json=json, quiet=quiet) as session:
        import numpy as np

        from pliant.iterative import IterativeBinding

        shape, offset = read_mesh(session, mesh), np.array(opt.three_numbers(move, "--move"))
        region, held = vertices(roi, shape, "--roi"), vertices(handle, shape, "--handle")
        facts: dict[str, object] = {}
        deformer = _deformer(method, region, held)
        with session.patience():
            bound = deformer.bind(shape)
            session.say(f"bound: {len(bound.constraints.free):,} vertices are free, {len(held):,} are the handle")
            goal = bound.rest + offset
            if isinstance(bound, IterativeBinding):
                solution = bound.solve(goal)
                facts = {"status": solution.status, "iterations": solution.iterations, "energy": solution.energy}
                session.say(f"{solution.status} after {solution.iterations} iterations, energy {solution.energy:.4g}")
            moved = deformer.moved(goal)(shape)
        report = write_mesh(session, moved, output, strict=strict)
        length = np.linalg.norm(moved.points - shape.points, axis=1)
        session.result(
            input=mesh,
            output=output,
            points=len(shape.points),
            moved=int((length > 0).sum()),
            displacement={"largest": float(length.max(initial=0.0))},
            losses=report.losses,
            notes=report.notes,
            **facts,
        )


def _deformer(method: Method, roi: NDArray[np.int64], handle: NDArray[np.int64]) -> SurfaceDeformer:
    if method is Method.arap:
        from pliant.surface.arap import ARAP

        return ARAP(roi, handle)
    if method is Method.laplacian:
        from pliant.surface.laplacian_edit import LaplacianEdit

        return LaplacianEdit(roi, handle)
    from pliant.surface.skeleton_edit import SkeletonEdit

    return SkeletonEdit(roi, handle)
