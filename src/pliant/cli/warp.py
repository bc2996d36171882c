"""``pliant warp``: an image in, the deformed image out."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session


class Interpolation(StrEnum):
    """How values between voxels are found."""

    linear = "linear"
    cubic = "cubic"


def warp(
    image: Annotated[Path, typer.Argument(metavar="IMAGE", show_default=False, help="NIfTI or MetaImage.")],
    transform: Annotated[Path, typer.Option("--transform", "-t", metavar="FILE", help="A transform file.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the result.")],
    reference: Annotated[
        Path | None,
        typer.Option(metavar="IMAGE", help="The grid of the result; the image's own otherwise.", show_default=False),
    ] = None,
    interpolation: Annotated[Interpolation, typer.Option(help="Between voxels.")] = Interpolation.linear,
    fill: Annotated[float, typer.Option(help="The value of what comes from outside the image.")] = 0.0,
    inverse: Annotated[
        bool, typer.Option("--inverse", help="The transform pushes forward: fetch by its inverse.")
    ] = False,
    edge: opt.EdgeOption = opt.Edge.clamp,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Deform an image.

    Each voxel of the result fetches its value from where the transform takes it, as registration tools do.
    """
    with Session(json=json, quiet=quiet) as session:
        from pliant.field.resampling import warp_image
        from pliant.io.conversion import inverted
        from pliant.io.images import read_image, write_image
        from pliant.io.transforms import read_transform

        source = read_image(image)
        grid = None if reference is None else read_image(reference)
        found = read_transform(transform, edge=edge.value)
        deformer = inverted(found) if inverse else found
        session.say(f"read {image}: {' x '.join(map(str, source.values.shape))} voxels")
        with session.patience():
            result = warp_image(source, deformer, reference=grid, interpolation=interpolation.value, fill=fill)
        report = write_image(result, output)
        session.tell_losses(report)
        session.say(f"wrote {output}")
        session.result(input=image, output=output, voxels=list(result.values.shape), notes=report.notes)
