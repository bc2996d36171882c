"""``pliant cage``: build a cage around a mesh; and the options that deform by one."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.space.cage import Cage


class Method(StrEnum):
    """How a cage is built."""

    offset = "offset"
    alpha_wrap = "alpha-wrap"
    box = "box"


class Coordinates(StrEnum):
    """Coordinates with respect to a cage."""

    mean_value = "mean-value"
    green = "green"
    harmonic = "harmonic"
    maximum_entropy = "maximum-entropy"
    quad_mean_value = "quad-mean-value"
    quad_green = "quad-green"


CageOption = Annotated[
    Path | None, typer.Option("--cage", metavar="FILE", help="A cage around the mesh: a closed mesh, at rest.")
]
PosedOption = Annotated[
    Path | None, typer.Option("--posed", metavar="FILE", help="The same cage with its vertices elsewhere.")
]
CoordinatesOption = Annotated[Coordinates, typer.Option(help="Coordinates with respect to --cage.")]


@dataclass(frozen=True)
class CageChoice:
    """The options of a cage, as they were typed."""

    cage: Path
    posed: Path | None
    coordinates: Coordinates

    def made(self) -> Cage:
        """The deformer.

        Raises
        ------
        typer.BadParameter
            A posed cage of another number of vertices.
        """
        from pliant.io.meshes import read
        from pliant.space.cage import Cage

        rest = read(self.cage)
        found = Cage(rest, coordinates=self.coordinates.value.replace("-", "_"))  # type: ignore[arg-type]
        if self.posed is None:
            return found
        posed = read(self.posed)
        if len(posed.points) != len(rest.points):
            raise typer.BadParameter(
                f"{self.posed} has {len(posed.points)} vertices, {self.cage} has {len(rest.points)}: a posed cage is "
                "the same cage with its vertices elsewhere",
                param_hint="--posed",
            )
        return found.moved(posed.points)


def cage_choice(cage: Path | None, posed: Path | None, coordinates: Coordinates) -> CageChoice | None:
    """The cage that was given, or none.

    Raises
    ------
    typer.BadParameter
        A posed cage without one at rest.
    """
    if cage is None:
        if posed is not None:
            raise typer.BadParameter("there is no cage at rest: add --cage FILE", param_hint="--posed")
        return None
    return CageChoice(cage, posed, coordinates)


def cage(
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the cage.")],
    vertices: Annotated[int, typer.Option(help="How many vertices the cage may have.")] = 150,
    margin: Annotated[float, typer.Option(help="Distance from the mesh, as part of its diagonal.")] = 0.02,
    method: Annotated[Method, typer.Option(help="Simplified offset, CGAL's alpha wrap, or a box.")] = Method.offset,
    cells: Annotated[str, typer.Option(metavar="NxNxN", help="Quadrangles along each axis of a box.")] = "1x1x1",
    own: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help="Your own coarse mesh: push it out until it encloses."),
    ] = None,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Build a cage: a coarse closed mesh around a mesh, to deform it by.

    The result is verified: closed, oriented, not cutting itself, enclosing every vertex and every face.
    """
    with Session(json=json, quiet=quiet) as session:
        from time import perf_counter

        from pliant.cages.boxes import cage_from_box
        from pliant.cages.building import build_cage
        from pliant.cages.checking import check_cage
        from pliant.cages.own import cage_from_mesh
        from pliant.io.meshes import read

        inner = read_mesh(session, mesh)
        start = perf_counter()
        with session.patience():
            if own is not None:
                found = cage_from_mesh(read(own), inner)
            elif method is Method.box:
                found = cage_from_box(inner, opt.lattice_shape(cells), margin)
            else:
                found = build_cage(inner, vertices, margin, method=method.value.replace("-", "_"))  # type: ignore[arg-type]
            report = check_cage(found, inner)
        seconds = perf_counter() - start
        ratio = "" if report.volume_ratio is None else f", {report.volume_ratio:.3g} times the mesh's volume"
        session.say(f"{report.vertices} vertices, {report.faces} faces{ratio}, in {seconds:.1f} s")
        for failure in report.failures:
            session.warn(f"the cage fails: {failure}")
        write_mesh(session, found, output)
        session.result(
            input=mesh,
            output=output,
            ok=report.ok,
            failures=list(report.failures),
            vertices=report.vertices,
            faces=report.faces,
            components=report.components,
            genus=report.genus,
            volume_ratio=report.volume_ratio,
            clearance=report.clearance,
            seconds=seconds,
        )
