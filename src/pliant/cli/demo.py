"""``pliant demo``: a shape, a deformation and pictures of them, made on the spot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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
"""


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Where to put it all.")] = Path(
        "pliant-demo"
    ),
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Make a vase, let it dance, and draw it.

    Start here: a mesh, a transform file, the deformed mesh and pictures, with what to try next.
    """
    with Session(json=json, quiet=quiet) as session:
        from pliant.errors import MissingExtra, NoGraphics

        mesh, ffd, swayed = output / "vase.obj", output / "sway.FFD", output / "vase-swayed.obj"
        vase = _make(session, mesh, ffd)
        deform_file(session, mesh, swayed, Choice(ffd=ffd))
        made = [mesh, mesh.with_name("vase.mtl"), mesh.with_name("glaze.png"), ffd, swayed]
        try:
            made += _draw(session, vase, ffd, output)
        except (MissingExtra, NoGraphics) as reason:
            session.warn(f"no pictures: {reason}")
        session.result(made=made)
        session.table({path.name: _MEANS.get(path.name, "") for path in made})
        session.say(_NEXT.format(mesh=mesh, ffd=ffd, swayed=swayed, folder=output))


_MEANS = {
    "vase.obj": "a vase of quadrangles, with texture coordinates",
    "vase.mtl": "its material",
    "glaze.png": "its texture",
    "sway.FFD": "a B-spline lattice of 4 x 4 x 6 control points",
    "vase-swayed.obj": "the vase, deformed: the same polygons, texture and material",
    "before.png": "the vase and the lattice at rest",
    "after.png": "both deformed",
    "grid.png": "how space around it is warped",
}


def _make(session: Session, mesh: Path, ffd: Path) -> PolygonMesh:
    """Write the vase with its texture, and the lattice."""
    from pliant import examples
    from pliant.io.files import write_bytes
    from pliant.io.meshes import read, write
    from pliant.io.png import png_bytes
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


def _draw(session: Session, vase: PolygonMesh, ffd: Path, folder: Path) -> list[Path]:
    """Pictures before and after, and of the warped space."""
    from pliant.io.transforms import read_transform
    from pliant.rendering.pictures import render

    bent = read_transform(ffd)
    pictures = {
        "before.png": (bent.moved(bent.rest), ("mesh", "lattice"), "texture"),
        "after.png": (bent, ("mesh", "lattice"), "texture"),
        "grid.png": (bent, ("mesh", "grid"), "displacement"),
    }
    made = []
    for name, (deformer, show, color) in pictures.items():
        made.append(folder / name)
        render(vase, deformer, made[-1], show=show, color=color)
        session.say(f"drew {made[-1]}")
    return made
