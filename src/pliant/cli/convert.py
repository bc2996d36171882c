"""``pliant convert``: the same mesh, or the same transform, in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session


def convert(
    source: Annotated[Path, typer.Argument(metavar="IN", show_default=False, help="A mesh or a transform file.")],
    output: Annotated[Path, typer.Argument(metavar="OUT", show_default=False, help="Its ending names the format.")],
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write a mesh or transform in another format.

    What that format cannot hold is told, and refused with --strict.
    """
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.files import read_bytes
        from pliant.io.meshes import read, write
        from pliant.io.transforms import read_transform, transform_format, write_transform

        if transform_format(source, read_bytes(source)):
            deformer = read_transform(source, variant=None if variant is None else variant.value, edge=edge.value)
            report = write_transform(deformer, output, strict=strict)
        else:
            report = write(read(source), output, strict=strict)
        for loss in report.losses:
            session.warn(f"{output} does not hold: {loss}")
        for note in report.notes:
            session.say(f"note: {note}")
        session.say(f"wrote {output} ({report.format})")
        session.result(input=source, output=output, format=report.format, losses=report.losses, notes=report.notes)
