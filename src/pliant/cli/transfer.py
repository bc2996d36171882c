"""``pliant transfer``: one mesh in the poses of another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import write_mesh
from pliant.cli.session import Session


def transfer(
    meshes: Annotated[
        list[Path],
        typer.Argument(metavar="SRC_REST SRC_POSE... TGT", help="The source at rest, its poses, and the target."),
    ],
    markers: Annotated[
        Path, typer.Option("--markers", metavar="FILE", help="Pairs of vertices, source and target, one a line.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Where to write the target's poses.")],
    correspondence: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Which triangles belong together: read, or written if it is not there."),
    ] = None,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Put a mesh into the poses of another one, of any connectivity."""
    if len(meshes) < 3:
        raise typer.BadParameter(
            "give the source at rest, at least one pose of it, and the target", param_hint="meshes"
        )
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.meshes import read
        from pliant.io.pairs import read_pairs, write_pairs
        from pliant.surface.transfer import DeformationTransfer

        source, target = read(meshes[0]), read(meshes[-1])
        known = read_pairs(correspondence) if correspondence is not None and correspondence.exists() else None
        with session.patience():
            clone = DeformationTransfer(source, target, read_pairs(markers), correspondence=known)
        session.say(f"{len(clone.correspondence):,} pairs of triangles belong together")
        if correspondence is not None and known is None:
            write_pairs(clone.correspondence, correspondence)
            session.say(f"wrote {correspondence}")
        written = []
        for pose in meshes[1:-1]:
            path = output / f"{meshes[-1].stem}-{pose.stem}{meshes[-1].suffix}"
            write_mesh(session, clone(read(pose)), path, strict=strict)
            written.append(path)
        session.result(source=meshes[0], target=meshes[-1], pairs=len(clone.correspondence), output=written)
