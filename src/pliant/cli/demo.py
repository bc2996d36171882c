"""``pliant demo``: a shape, deformations, pictures and an animation of it, made on the spot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pliant.cli import options as opt
from pliant.cli.choice import Choice
from pliant.cli.deform import deform_file
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.mesh import PolygonMesh

_NEXT = """\
Try next:
  pliant info {ffd}
  pliant deform {mesh} --lattice 4x4x4 --move 3,3,3:60,60,40 -o {folder}/pulled.obj
  pliant render {mesh} --ffd {ffd} --show mesh,arrows --color displacement -o {folder}/arrows.png
  pliant deform {swayed} --ffd {ffd} --inverse -o {folder}/back.obj
  pliant animate bounce {mesh} -o {folder}/bounce.glb
  pliant studio {mesh} --ffd {ffd}
"""


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Where to put it all.")] = Path(
        "pliant-demo"
    ),
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Make a vase, let it dance, and draw it.

    Start here: a mesh, a transform file, deformed meshes, pictures and an animation, with what to try next.
    """
    with Session(json=json, quiet=quiet) as session:
        mesh, ffd, swayed = output / "vase.obj", output / "sway.FFD", output / "vase-swayed.obj"
        vase = _make(session, mesh, ffd)
        deform_file(session, mesh, swayed, Choice(ffd=ffd))
        made = [mesh, mesh.with_name("vase.mtl"), mesh.with_name("glaze.png"), ffd, swayed]
        made += _wring(session, vase, output)
        made += _draw(session, vase, ffd, output)
        made += _dance(session, vase, ffd, output)
        session.result(made=made)
        session.table({path.name: _MEANS.get(path.name, "") for path in made})
        session.say(_NEXT.format(mesh=mesh, ffd=ffd, swayed=swayed, folder=output))


_MEANS = {
    "vase.obj": "a vase of quadrangles, with texture coordinates",
    "vase.mtl": "its material",
    "glaze.png": "its texture",
    "sway.FFD": "a B-spline lattice of 4 x 4 x 6 control points",
    "vase-swayed.obj": "the vase, deformed: the same polygons, texture and material",
    "vase-wrung.obj": "the vase, twisted and squeezed: closed forms, no lattice",
    "before.png": "the vase and the lattice at rest",
    "after.png": "both deformed",
    "grid.png": "how space around it is warped",
    "dance.glb": "the vase dances: for browsers, Blender and game engines",
    "dance.gif": "the same as a film",
}


def _make(session: Session, mesh: Path, ffd: Path) -> PolygonMesh:
    """Write the vase with its texture, and the lattice."""
    from pliant import examples
    from pliant.io.files import write_bytes
    from pliant.io.image_formats.png import png_bytes
    from pliant.io.meshes import read, write
    from pliant.io.transforms import write_transform
    from pliant.space.bspline_ffd import BSplineFFD

    texture = mesh.with_name("glaze.png")
    write_bytes(texture, png_bytes(examples.glaze()))
    vase = examples.vase(texture=texture)
    write(vase, mesh)
    lattice = BSplineFFD.around(vase, shape=(4, 4, 6), margin=0.02)
    write_transform(lattice.moved(examples.sway(lattice.rest)), ffd)
    session.say(f"made {mesh} and {ffd}")
    return read(mesh)


def _wring(session: Session, vase: PolygonMesh, folder: Path) -> list[Path]:
    """Twist the vase, and squeeze its waist at the same volume."""
    from pliant.io.meshes import write
    from pliant.space.compose import compose
    from pliant.space.squash import Squash
    from pliant.space.twist import Twist

    path = folder / "vase-wrung.obj"
    write(compose(Squash.around(vase, factor=1.25), Twist.around(vase, profile="smooth", angle=2.0))(vase), path)
    session.say(f"wrote {path}")
    return [path]


def _draw(session: Session, vase: PolygonMesh, ffd: Path, folder: Path) -> list[Path]:
    """Pictures before and after, and of the warped space, where they can be drawn."""
    from pliant.errors import MissingExtra, NoGraphics
    from pliant.io.transforms import read_transform
    from pliant.rendering import pictures

    bent = read_transform(ffd)
    wanted = {
        "before.png": (bent.moved(bent.rest), ("mesh", "lattice"), "texture"),
        "after.png": (bent, ("mesh", "lattice"), "texture"),
        "grid.png": (bent, ("mesh", "grid"), "displacement"),
    }
    made = []
    try:
        for name, (deformer, show, color) in wanted.items():
            pictures.render(vase, deformer, folder / name, show=show, color=color)
            made.append(folder / name)
            session.say(f"drew {made[-1]}")
    except (MissingExtra, NoGraphics) as reason:
        session.warn(f"no pictures: {reason}")
    return made


def _dance(session: Session, vase: PolygonMesh, ffd: Path, folder: Path) -> list[Path]:
    """The vase sways to one side and to the other, for ever; as a film where it can be drawn."""
    from pliant import examples
    from pliant.errors import MissingExtra, NoGraphics
    from pliant.io.transforms import read_transform
    from pliant.scene.clip import Clip
    from pliant.scene.layer import Layer
    from pliant.scene.stack import Stack

    lattice = read_transform(ffd)
    clip = Clip(vase, Stack((Layer("sway", lattice.moved(lattice.rest)),)), duration=2.0, fps=8, ending="loop")
    for time, part in ((0.0, 0.0), (0.5, 1.0), (1.0, 0.0), (1.5, -1.0), (2.0, 0.0)):
        pose = examples.sway(lattice.rest, turn=part, lean=0.15 * part)
        clip = clip.key("sway", time, {"controls": pose if part else lattice.rest}, "smooth")
    made = []
    try:
        looks: dict[str, dict[str, Any]] = {"dance.glb": {}, "dance.gif": {"size": (480, 560)}}
        for name, look in looks.items():
            clip.export(folder / name, **look)
            made.append(folder / name)
            session.say(f"wrote {made[-1]}")
    except (MissingExtra, NoGraphics) as reason:
        session.warn(f"no film: {reason}")
    return made
