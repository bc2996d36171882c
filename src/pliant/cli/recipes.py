"""``pliant apply``, ``animate``, ``templates`` and ``export-recipe``: stacks and motions on the command line."""

from __future__ import annotations

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli import options as opt
from pliant.cli.meshes import read_mesh, write_mesh
from pliant.cli.part import ToleranceOption, deform_part, is_part
from pliant.cli.pieces import deform_in_pieces
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.mesh import PolygonMesh
    from pliant.scene.clip import Clip
    from pliant.scene.recipe import Recipe
    from pliant.scene.scene import Scene
    from pliant.scene.stack import Stack


class Up(StrEnum):
    """The axis that points up."""

    y = "y"
    z = "z"


RecipeArgument = Annotated[
    str,
    typer.Argument(
        metavar="RECIPE", show_default=False, help="A recipe (.toml), a project (.pliant) or a template's name."
    ),
]
IntensityOption = Annotated[float, typer.Option(help="How far the deformation goes; 1 = as the recipe says.")]
UpOption = Annotated[Up, typer.Option(help="The axis that points up in the mesh.")]
DurationOption = Annotated[
    float | None, typer.Option(metavar="SECONDS", show_default=False, help="How long the motion lasts.")
]


def apply(
    recipe: RecipeArgument,
    mesh: opt.MeshArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write the deformed mesh.")],
    intensity: IntensityOption = 1.0,
    up: UpOption = Up.z,
    time: Annotated[
        float | None, typer.Option(metavar="SECONDS", show_default=False, help="A moment of its motion.")
    ] = None,
    tolerance: ToleranceOption = None,
    stream: opt.StreamOption = False,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Deform a mesh, or a part from CAD, by a recipe, a project or a template."""
    with Session(json=json, quiet=quiet) as session:
        choice = partial(_stack, recipe, intensity=intensity, up=up)  # for the mesh, the part's mesh, or a box
        if stream and time is not None:
            raise typer.BadParameter(
                "a moment of a motion needs the whole mesh: leave out --stream", param_hint="--time"
            )
        if is_part(mesh):
            deform_part(session, mesh, output, choice, tolerance, strict=strict)
            return
        if stream:
            deform_in_pieces(session, mesh, output, choice)
            return
        import numpy as np

        shape = read_mesh(session, mesh)
        with session.patience():
            if time is None:
                moved = choice(shape)(shape)
            else:
                moved = _clip(recipe, shape, intensity, up, None, None).sample(time)
        length = np.linalg.norm(moved.points - shape.points, axis=1)
        report = write_mesh(session, moved, output, strict=strict)
        session.result(
            input=mesh,
            output=output,
            points=len(shape.points),
            displacement={"mean": float(length.mean()), "largest": float(length.max(initial=0.0))},
            losses=report.losses,
            notes=report.notes,
        )


def animate(
    recipe: RecipeArgument,
    mesh: opt.MeshArgument,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="OUT", help=".glb, .usd, .pc2, .mdd, .pvd, .abc, .mp4 or .gif.")
    ],
    intensity: IntensityOption = 1.0,
    up: UpOption = Up.z,
    duration: DurationOption = None,
    fps: Annotated[float | None, typer.Option(help="Frames a second.", show_default=False)] = None,
    motion: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A motion of the mesh to be deformed: .pc2, .mdd, .pvd, .glb, .usd."),
    ] = None,
    amplify: Annotated[float, typer.Option(help="How much that motion is exaggerated.")] = 1.0,
    turns: Annotated[float, typer.Option(help="How often the viewer walks around, in films.")] = 0.0,
    size: Annotated[str | None, typer.Option(metavar="WxH", help="Pixels of a film.", show_default=False)] = None,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Move a mesh over time by a recipe, a project or a template."""
    with Session(json=json, quiet=quiet) as session:
        from dataclasses import replace

        from pliant.scene.animation.formats import export_clip, read_sequence

        shape = read_mesh(session, mesh)
        clip = _clip(recipe, shape, intensity, up, duration, fps)
        if motion is not None:
            found = read_sequence(motion, mesh=shape, fps=clip.fps)
            lasting = clip.duration if duration is not None else max(found.duration, 1 / clip.fps)
            clip = replace(clip, motion=found, amplify=amplify, duration=lasting)
        with session.patience():
            report = export_clip(clip, output, **_film_options(output, turns, size, up))
        session.tell_losses(report)
        session.say(f"wrote {output}: {len(clip.times)} frames")
        session.result(
            input=mesh, output=output, frames=len(clip.times), seconds=clip.period, losses=report.losses,
            notes=report.notes,
        )  # fmt: skip


def export_recipe(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", show_default=False, help="A project file, .pliant.")],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="OUT", help="The recipe to write, .toml.")],
    title: Annotated[str, typer.Option(help="What people call it.")] = "",
    fit: Annotated[bool, typer.Option("--fit", help="Made for the project's mesh, it fits others, too.")] = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write the stack and the keys of a project as a recipe, which people read and edit."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.scene.project import load_project
        from pliant.scene.recipe_writing import write_recipe

        scene = load_project(project)
        write_recipe(scene.clip or scene.stack, output, title=title, mesh=scene.mesh if fit else None)
        session.say(f"wrote {output}: {len(scene.stack)} layers")
        session.result(input=project, output=output, layers=list(scene.stack.names))


def templates(json: opt.JsonOption = False) -> None:
    """List the templates: ready deformations that fit any mesh."""
    with Session(json=json) as session:
        from pliant.scene.template_library import templates as all_templates

        found = all_templates()
        session.table({name: recipe.about for name, recipe in found.items()})
        session.result(templates={name: {"title": each.title, "about": each.about} for name, each in found.items()})


def _stack(recipe: str, mesh: PolygonMesh, intensity: float, up: Up) -> Stack:
    if recipe.lower().endswith(".pliant"):
        return _project(recipe, mesh, intensity, up).stack
    return _recipe(recipe).stack(mesh, intensity=intensity, up=up.value)


def _clip(recipe: str, mesh: PolygonMesh, intensity: float, up: Up, duration: float | None, fps: float | None) -> Clip:
    if not recipe.lower().endswith(".pliant"):
        return _recipe(recipe).clip(mesh, intensity=intensity, up=up.value, duration=duration, fps=fps)
    from dataclasses import replace

    scene = _project(recipe, mesh, 1.0, up)
    if scene.clip is None:
        raise typer.BadParameter("the project has no motion: set keys, or use apply", param_hint="RECIPE")
    changes: dict[str, Any] = {"duration": duration, "fps": fps, "intensity": None if intensity == 1.0 else intensity}
    return replace(scene.clip, **{name: value for name, value in changes.items() if value is not None})


def _project(path: str, mesh: PolygonMesh, intensity: float, up: Up) -> Scene:
    from pliant.scene.project import load_project

    if intensity != 1.0 or up is not Up.z:
        raise typer.BadParameter("a project's stack is applied as it is: leave out --intensity and --up")
    return load_project(path, mesh=mesh)


def _recipe(name: str) -> Recipe:
    if name.lower().endswith(".toml"):
        from pliant.scene.recipe import read_recipe

        return read_recipe(name)
    from pliant.scene.template_library import template

    return template(name)


def _film_options(output: Path, turns: float, size: str | None, up: Up) -> dict[str, Any]:
    """What films are told, and other formats need not be."""
    ending = output.suffix.lower()
    if ending not in (".mp4", ".gif"):
        if turns or size is not None:
            raise typer.BadParameter(f"{ending} is no film: leave out --turns and --size")
        return {"up": up.value} if ending in (".usd", ".usda", ".usdc") else {}
    options: dict[str, Any] = {"turns": turns, "up": up.value}
    if size is not None:
        words = size.lower().split("x")
        if len(words) != 2 or not all(word.isdecimal() for word in words):
            raise typer.BadParameter(f"{size!r} is no size, as in 960x720", param_hint="--size")
        options["size"] = (int(words[0]), int(words[1]))
    return options
