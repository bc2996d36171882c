"""``pliant convert``: the same mesh, or the same transform, in another format."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.io.report import LossReport

InverseOption = Annotated[bool, typer.Option("--inverse", help="Transforms: write the inverse map.")]
ControlsOption = Annotated[
    str | None,
    typer.Option("--lattice", metavar="NxNxN", help="Transforms: refit with so many control points or nodes."),
]
AroundOption = Annotated[
    Path | None,
    typer.Option("--around", metavar="MESH", help="Transforms: the mesh whose box a refit covers.", show_default=False),
]


def convert(
    source: Annotated[Path, typer.Argument(metavar="IN", show_default=False, help="A mesh or a transform file.")],
    output: Annotated[Path, typer.Argument(metavar="OUT", show_default=False, help="Its ending names the format.")],
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    inverse: InverseOption = False,
    lattice: ControlsOption = None,
    around: AroundOption = None,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write a mesh or transform in another format.

    Where the other format cannot hold a transform, the nearest one that it can is fitted, and how far it is off is
    told. What a format cannot hold is told, and refused with --strict.
    """
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.files import read_bytes
        from pliant.io.transforms import transform_format

        if transform_format(source, read_bytes(source)):
            shape = None if lattice is None else opt.lattice_shape(lattice)
            choices = (None if variant is None else variant.value, edge.value)
            with session.patience():
                report = _transform(source, output, choices, inverse, shape, around, strict=strict)
        else:
            if inverse or lattice or around:
                raise typer.BadParameter("--inverse, --lattice and --around are for transforms; this is a mesh")
            report = _mesh(source, output, strict=strict)
        session.tell_losses(report)
        session.say(f"wrote {output} ({report.format})")
        session.result(input=source, output=output, format=report.format, losses=report.losses, notes=report.notes)


def _mesh(source: Path, output: Path, *, strict: bool) -> LossReport:
    from pliant.io.meshes import read, write

    return write(read(source), output, strict=strict)


def _transform(
    source: Path,
    output: Path,
    choices: tuple[str | None, str],
    inverse: bool,
    shape: tuple[int, int, int] | None,
    around: Path | None,
    *,
    strict: bool,
) -> LossReport:
    from dataclasses import replace

    from pliant.io.conversion import convert_transform, direction_note, inverted
    from pliant.io.meshes import read
    from pliant.io.transforms import read_transform

    variant, edge = choices
    found = read_transform(source, variant=variant, edge=edge)  # type: ignore[arg-type]
    deformer = inverted(found) if inverse else found
    box = None if around is None else read(around)
    report = convert_transform(deformer, output, around=box, shape=shape, strict=strict)
    return report if inverse else replace(report, notes=report.notes + direction_note(found, output))
