"""An option for every deformer that a few numbers control, made from its fields: ``--twist axis=z,angle=90``.

Nothing is listed here: of the kinds of deformers, each map of space that names its ``parameters`` and can be laid
``around`` a mesh has an option of its name. They are looked for only where one is used, or help is asked for.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from pliant.deformer import Deformer, SpaceDeformer
    from pliant.mesh import PolygonMesh

Step = tuple[str, str]
"""A deformer's option and its fields, as they were typed."""

STEPS = "pliant.steps"
BASES = ("--ffd", "--lattice", "--dirichlet", "--cylinder", "--prism", "--sphere", "--cage")


class DeformingCommand(TyperCommand):
    """A command with an option for every deformer; their order on the line is the order of the deformations."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Take the deformers' options off the line, before the others are parsed."""
        known = {name for param in self.params for name in (*param.opts, *param.secondary_opts)}
        steps: list[Step] = []
        left = []
        words = iter(args)
        for word in words:
            name, equals, value = word.partition("=")
            if name in BASES:
                steps = [step for step in steps if step[0] not in BASES] + [(name, "")]
            if not name.startswith("--") or len(name) == 2 or name in known or name[2:] not in deformers():
                left.append(word)
                continue
            if not equals:
                value = next(words, "-")
                if value.startswith("-"):
                    raise _unsaid(name[2:])
            steps.append((name[2:], value))
        ctx.meta[STEPS] = tuple(steps)
        return list(super().parse_args(ctx, left))

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """The command's options, then the deformers'."""
        super().format_options(ctx, formatter)
        rows = [(f"--{name} FIELD=VALUE,...", _help(kind)) for name, kind in deformers().items()]
        with formatter.section("Deformations, applied in the order given"):
            formatter.write_text(
                "Each FIELD may be left out: what the mesh can tell is taken from it. Angles are in degrees; numbers "
                "that belong together are joined by colons, as in axis=1:0:1 or bounds=0:10, rows of them by slashes."
            )
            formatter.write_dl(rows)


def deformers() -> dict[str, type[Deformer]]:
    """The deformers that have an option, by its name."""
    from pliant.scene.kinds import all_kinds

    return {name: kind.cls for name, kind in all_kinds().items() if kind.space and _has_option(kind.cls)}


def made(step: Step, mesh: PolygonMesh) -> SpaceDeformer:
    """The deformer of an option, laid around a mesh.

    Raises
    ------
    typer.BadParameter
        A field that the deformer has not, or a value that is not understood.
    """
    name, text = step
    kind: Any = deformers()[name]
    fields = {field.name: field for field in dataclasses.fields(kind)}
    given: dict[str, Any] = {}
    for word in filter(None, text.split(",")):
        key, equals, value = (part.strip() for part in word.partition("="))
        if not equals or not value or key not in fields:
            raise typer.BadParameter(
                f"{word!r} is no field of it; it has: {', '.join(fields)} (as in {_example(kind)})",
                param_hint=f"--{name}",
            )
        given[key] = _value(value, radians=fields[key].metadata.get("unit") == "radians", option=f"--{name}")
    if not given:
        raise _unsaid(name)
    laid: SpaceDeformer = kind.around(mesh, **given)
    return laid


def _unsaid(name: str) -> typer.BadParameter:
    return typer.BadParameter(f"say how, as in --{name} {_example(deformers()[name])}", param_hint=f"--{name}")


def _has_option(kind: Any) -> bool:
    named = getattr(kind, "parameters", ())
    return isinstance(named, tuple) and bool(named) and hasattr(kind, "around") and not inspect.isabstract(kind)


def _value(text: str, *, radians: bool, option: str) -> Any:
    """A word, a number, numbers joined by colons, or rows of them joined by slashes."""
    if re.fullmatch(r"[A-Za-z_]+", text) and text.lower() not in ("nan", "inf"):
        return text
    try:
        rows = [tuple(float(number) for number in row.split(":")) for row in text.split("/")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} holds something that is no number", param_hint=option) from None
    if len(rows) > 1:
        return tuple(rows)
    if len(rows[0]) > 1:
        return rows[0]
    if radians:
        from math import radians as to_radians

        return to_radians(rows[0][0])
    return rows[0][0]


def _help(kind: Any) -> str:
    """What a deformer does, and its fields with what they are when left out."""
    summary = (inspect.getdoc(kind) or "").partition("\n")[0].replace("``", "")
    shown = []
    for field in dataclasses.fields(kind):
        parameter = field.name in kind.parameters
        shown.append(f"{field.name}={field.default:g}" if parameter else field.name)
    shown.sort(key=lambda word: "=" not in word)
    return f"{summary} Fields: {', '.join(shown)}."


def _example(kind: Any) -> str:
    first = kind.parameters[0]
    unit = next(field.metadata.get("unit") for field in dataclasses.fields(kind) if field.name == first)
    return f"{first}=45" if unit == "radians" else f"{first}=0.5"
