"""``pliant batch``: a recipe for many files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli import options as opt
from pliant.cli.exits import Exit
from pliant.cli.recipes import IntensityOption, Up, UpOption
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.scene.recipe import Recipe
    from pliant.scene.stack import Stack


def batch(
    meshes: Annotated[
        list[str],
        typer.Argument(metavar="MESH...", show_default=False, help="Files, or patterns such as 'cohort/*.ply'."),
    ],
    recipe: Annotated[
        str, typer.Option("--recipe", "-r", metavar="RECIPE", help="A .toml, a .pliant, or a template's name.")
    ],
    output: Annotated[
        str,
        typer.Option(
            "--output", "-o", metavar="PATTERN", help="As in 'out/{stem}.ply'; also {suffix}, {parent} and {index}."
        ),
    ],
    workers: Annotated[
        int | None,
        typer.Option(min=0, show_default=False, help="Processes; 0 = this one alone. By default one a processor."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", show_default=False, help="A Dask cluster's, as in tcp://10.0.0.1:8786."),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out what an earlier run has done.")] = False,
    intensity: IntensityOption = 1.0,
    up: UpOption = Up.z,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Deform many meshes by a recipe.

    A mesh that fails does not stop the others; the exit code is then 3. What is done stands in pliant-batch.jsonl
    beside the outputs, so that a run which was cut off goes on with --resume.
    """
    if scheduler is not None and workers is not None:
        raise typer.BadParameter("a cluster knows its workers: leave out --workers or --scheduler")
    paths = _paths(meshes)
    with Session(json=json, quiet=quiet) as session:
        from pliant.batch.running import run_batch

        with _cluster(scheduler) as executor:
            run = run_batch(
                _deformation(recipe),
                paths,
                output,
                executor=executor,
                workers=workers,
                resume=resume,
                strict=strict,
                intensity=intensity,
                up=up.value,
            )
            found = []
            for outcome in run:
                found.append(outcome)
                count = f"[{len(found)}/{len(paths)}]"
                if outcome.status == "failed":
                    session.warn(f"{count} {outcome.input}: {outcome.error}")
                else:
                    session.say(f"{count} {outcome.output}" + (" (done before)" if outcome.resumed else ""))
                for loss in outcome.losses:
                    session.warn(f"{outcome.output} does not hold: {loss}")
        failures = sum(outcome.status == "failed" for outcome in found)
        session.table({"done": str(len(found) - failures), "failed": str(failures)})
        session.result(done=len(found) - failures, failed=failures, outcomes=sorted(found, key=lambda each: each.index))
    if failures:
        raise typer.Exit(Exit.UNREADABLE)


def _paths(patterns: list[str]) -> list[Path]:
    """Files by name, and what patterns stand for, sorted; each once."""
    import glob

    found: dict[Path, None] = {}
    for pattern in patterns:
        plain = Path(pattern).is_file() or not glob.has_magic(pattern)
        names = [pattern] if plain else sorted(glob.iglob(pattern, recursive=True))  # noqa: PTH207 -- absolute ones too
        if not names:
            raise typer.BadParameter(f"no file is called as in {pattern!r}", param_hint="MESH")
        found.update(dict.fromkeys(map(Path, names)))
    return list(found)


def _deformation(name: str) -> Recipe | Stack:
    if name.lower().endswith(".pliant"):
        from pliant.scene.project import load_project

        return load_project(name).stack
    if name.lower().endswith(".toml"):
        from pliant.scene.recipe import read_recipe

        return read_recipe(name)
    from pliant.scene.template_library import template

    return template(name)


@contextmanager
def _cluster(address: str | None) -> Iterator[Any]:
    """A client of the cluster at an address; None where there is no address."""
    if address is None:
        yield None
        return
    from pliant.errors import InvalidParameter, MissingExtra

    try:
        import distributed
    except ImportError:
        raise MissingExtra("a cluster", "dask") from None
    try:
        connect: Any = distributed.Client
        client = connect(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise InvalidParameter(f"there is no scheduler at {address}: {error} (start one by: dask scheduler)") from error
    with client:
        yield client
