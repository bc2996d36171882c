"""``pliant studio``: the editor in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session


def studio(
    file: Annotated[
        Path | None, typer.Argument(metavar="[MESH|PROJECT]", show_default=False, help="A mesh, or a .pliant project.")
    ] = None,
    ffd: opt.FFDOption = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, show_default=False, help="Where to listen on this machine.")
    ] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the browser.")] = True,
    root: Annotated[
        Path | None,
        typer.Option(metavar="DIR", show_default=False, help="The folder whose files the page may open. [the file's]"),
    ] = None,
    quiet: opt.QuietOption = False,
) -> None:
    """Edit a shape by hand, in the browser.

    Needs the extra 'studio'. Listens on this machine only; the address that it prints holds a key. Ctrl-C ends it.
    """
    with Session(quiet=quiet) as session:
        from pliant.errors import InvalidParameter
        from pliant.studio.serving.launching import launch

        if root is not None and not root.is_dir():
            raise InvalidParameter(f"{root} is no folder: --root names the one whose files the page may open")
        folder = root or (file.parent if file is not None else Path())
        scene = None
        if file is not None:
            from pliant.studio.commands.opening import read_scene

            scene = read_scene(file)
            if ffd is not None:
                from pliant.io.transforms import read_transform
                from pliant.studio.modes.layering import with_layer

                stack, _ = with_layer(scene.stack, ffd.stem, read_transform(ffd, target=scene.mesh))
                scene = scene.replace(stack=stack)
        elif ffd is not None:
            raise typer.BadParameter("a deformation needs a mesh: pliant studio MESH --ffd FILE", param_hint="--ffd")
        launched = launch(scene, "" if file is None else file.stem, port=port, root=folder)
        print(launched.url, flush=True)
        session.say("the studio is open; Ctrl-C ends it")
        if browser and not launched.open_browser():
            session.say("no browser was found: open the address above")
        launched.run()
