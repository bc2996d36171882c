"""``pliant info``: what a file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from pliant.cli import options as opt
from pliant.cli.part import facts_of_part, is_part
from pliant.cli.session import Session


def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", show_default=False, help="A mesh, transform, image or part.")],
    variant: opt.VariantOption = None,
    edge: opt.EdgeOption = opt.Edge.clamp,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Tell what a mesh, a transform, an image or a part from CAD holds."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.cli import facts
        from pliant.io.files import read_bytes
        from pliant.io.images import is_image, read_image
        from pliant.io.meshes import read
        from pliant.io.transforms import read_transform, transform_format

        found: dict[str, Any]
        data = read_bytes(file)
        if known := transform_format(file, data):
            deformer = read_transform(file, variant=None if variant is None else variant.value, edge=edge.value)
            conventions = {name: value for name, value in vars(known.conventions).items() if name != "holds"}
            found = {"file": str(file), "format": known.name, **conventions, **facts.of_transform(deformer)}
        elif is_part(file):
            from pliant.cad import read as read_part

            found = {"file": str(file), **facts_of_part(read_part(file))}
        elif is_image(data):
            found = {"file": str(file), **facts.of_image(read_image(file))}
        else:
            found = {"file": str(file), **facts.of_mesh(read(file))}
        session.result(**found)
        session.table({name.replace("_", " "): _shown(value) for name, value in found.items()})


def _shown(value: Any) -> str:
    """A value for people."""
    if isinstance(value, dict):
        return ", ".join(f"{name.replace('_', ' ')} {_shown(inner)}" for name, inner in value.items()) or "nothing"
    if isinstance(value, list):
        if value and isinstance(value[0], list):
            return "; ".join(_shown(row) for row in value)
        return (", " if value and isinstance(value[0], str) else " ").join(map(_shown, value)) or "nothing"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
