"""The commands of ``pliant``."""

from __future__ import annotations

from typing import Annotated

import typer

from pliant.cli.batch import batch
from pliant.cli.cage import cage
from pliant.cli.check import check
from pliant.cli.convert import convert
from pliant.cli.deform import deform
from pliant.cli.deformer_options import DeformingCommand
from pliant.cli.demo import demo
from pliant.cli.edit import edit
from pliant.cli.exits import EXPLAINED
from pliant.cli.face import face
from pliant.cli.info import info
from pliant.cli.model import app as model
from pliant.cli.recipes import animate, apply, export_recipe, templates
from pliant.cli.render import render
from pliant.cli.skeleton import skeleton
from pliant.cli.smooth import smooth
from pliant.cli.studio import studio
from pliant.cli.transfer import transfer
from pliant.cli.warp import warp

app = typer.Typer(
    name="pliant",
    no_args_is_help=True,
    rich_markup_mode=None,  # plain help costs 70 ms, rich help 270
    pretty_exceptions_enable=False,  # bugs are reported by the entry point
    epilog=EXPLAINED,
)
for command in (
    deform,
    warp,
    edit,
    skeleton,
    apply,
    batch,
    animate,
    templates,
    export_recipe,
    smooth,
    transfer,
    cage,
    info,
    check,
    convert,
    render,
    face,
    studio,
    demo,
):
    app.command(cls=DeformingCommand if command in (deform, render) else None)(command)

app.add_typer(model, name="model")


def _version(wanted: bool) -> None:
    if wanted:
        from pliant._version import __version__

        print(f"pliant {__version__}")
        raise typer.Exit


@app.callback()
def pliant(
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of a bug.")] = False,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Deform 3-D shapes: control many points with few.

    Start with: pliant demo
    """
