"""The corpus: small sound files of every kind that pliant reads. `python -m reliability.seeds` writes it anew.

A folder is a kind, and names which reader its files are for. Some files are written by hand, and hold what pliant
itself never writes; the others are what its writers make of small shapes.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

import pliant as pl
from reliability import handmade

CORPUS = Path(__file__).with_name("corpus")
SHAPE = pl.PolygonMesh(
    np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]]),
    [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
)
BOX = pl.PolygonMesh(
    np.array([[-1, -1, -1], [2, -1, -1], [2, 2, -1], [-1, 2, -1], [-1, -1, 2], [2, -1, 2], [2, 2, 2], [-1, 2, 2]]),
    np.array([[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7],
              [2, 7, 6], [3, 0, 4], [3, 4, 7]]),
)  # fmt: skip
_RANDOM = np.random.default_rng(0)
_POINTS = _RANDOM.uniform(-10, 10, (12, 3))
_FFD = pl.BSplineFFD(displacements=_RANDOM.normal(size=(4, 5, 4, 3)), origin=(0, 1, 2), spacing=(2, 3, 4), edge="zero")
_GRID = pl.DisplacementGrid(
    displacements=_RANDOM.normal(size=(3, 2, 3, 3)), origin=(0, 1, 2), spacing=(2, 3, 4), rim=0.5
)
_TURN = pl.Affine.rotation("x", 0.3)


def meshes(folder: Path) -> None:
    """Every mesh format."""
    _put(folder, handmade.MESHES)
    shape = pl.PolygonMesh(np.eye(3), [[0, 1, 2]], vertex_attributes={"heat": np.arange(3.0)})
    for name in ("written.vtp", "written.vtk", "written.vtu", "written.msh", "written.ply.gz"):
        pl.write(shape, folder / name)


def transforms(folder: Path) -> None:
    """Every transform format."""
    box = pl.BezierFFD.around(np.eye(3), shape=(3, 2, 2))
    made = {
        "a.FFD": _FFD,
        "a.AFF": _TURN,
        "a.tfm": pl.compose(_TURN, _FFD, _GRID),
        "a.h5": _FFD,
        "a.0.txt": _FFD,
        "affine.txt": _TURN,
        "a.nii": _FFD,
        "b.nii.gz": _GRID,
        "a.mha": _GRID,
        "a.vti": _GRID,
        "a.dof": pl.compose(_TURN, _FFD),
        "a.dof.gz": _FFD,
        "a.prm": box.moved(box.rest + 0.01 * _POINTS.reshape(3, 2, 2, 3)),
        "a.xyz": pl.ClampedFFD.around(np.eye(3), shape=(2, 5, 2)),
    }
    for name, deformer in made.items():
        pl.write_transform(deformer, folder / name)


def models(folder: Path) -> None:
    """Shape models, in HDF5 and in JSON."""
    kernel = pl.GaussianKernel(sigma=4.0, scale=0.1)
    model = pl.ShapeModel.from_kernel(SHAPE.replace(faces=SHAPE.triangles), kernel, rank=3)
    pl.write_model(model, folder / "model.h5")
    pl.write_model(model, folder / "model.h5.json")


def _scene() -> pl.Scene:
    at_rest = pl.BSplineFFD.around(SHAPE, shape=(3, 3, 3))
    warp = at_rest.moved(at_rest.rest + 0.02)
    stack = pl.Stack([
        pl.Layer("warp", warp),
        pl.Layer("edit", pl.LaplacianEdit(np.arange(5), np.array([4])), mask=np.linspace(0, 1, 5)),
        pl.Layer("cage", pl.Cage(BOX)),
        pl.Layer("twist", pl.Twist.around(SHAPE, axis="z", angle=0.5), envelope=0.5),
    ])  # fmt: skip
    clip = pl.Clip(SHAPE, stack, duration=2.0, fps=1).key("twist", 0.0, {"angle": 0.0})
    return pl.Scene(SHAPE, stack, clip.key("twist", 2.0, {"angle": 1.5}, easing="ease_in_out"), {"top": [4]})


def projects(folder: Path) -> None:
    """A scene with everything, and one of many kinds of deformers."""
    pl.save_project(_scene(), folder / "scene.pliant")
    points = SHAPE.points
    layers = {
        "free": pl.DirichletFFD(points + 0.1),
        "bend": pl.Bend.around(SHAPE, axis="y", angle=0.3, normal="z"),
        "wave": pl.Wave.around(SHAPE, amplitude=0.1),
        "spline": pl.ThinPlateSpline(points, points + 0.1),
        "warp": pl.RadialBasisWarp(points, points + 0.1),
        "drum": pl.ExtendedFFD.cylinder(SHAPE, axis="z", shape=(5, 4, 4)),
        "grid": pl.DisplacementGrid(displacements=np.full((3, 3, 3, 3), 0.1), origin=(0, 0, 0), spacing=(1, 1, 1)),
        "place": pl.place(pl.Scale(x=1.2, y=0.7), _TURN),
        "keys": pl.ShapeKeys(np.full((1, 5, 3), 0.1), ("up",), [0.5]),
        "back": pl.Inverse(pl.Taper.around(SHAPE, axis="z", factor=0.5)),
    }
    stack = pl.Stack([pl.Layer(name, deformer) for name, deformer in layers.items()])
    pl.save_project(pl.Scene(SHAPE, stack), folder / "kinds.pliant")


def landmarks(folder: Path) -> None:
    """Landmarks of every dress."""
    _put(folder, handmade.LANDMARKS)


def recipes(folder: Path) -> None:
    """One recipe by hand, and one of a scene."""
    _put(folder, {"fits.toml": handmade.RECIPE})
    scene = _scene()
    assert scene.clip is not None
    pl.write_recipe(scene.clip, folder / "scene.toml")


def sequences(folder: Path) -> None:
    """A motion in every format that holds one."""
    scene = _scene()
    assert scene.clip is not None
    for name in ("a.pc2", "a.mdd", "a.glb", "a.gltf", "a.usda", "a.usdc", "a.abc", "a.pvd"):
        scene.clip.export(folder / name)


def images(folder: Path) -> None:
    """Volumes of grey values."""
    volume = pl.Image(np.arange(24.0).reshape(2, 3, 4), np.zeros(3), np.ones(3))
    for name in ("a.nii", "a.nii.gz", "a.mha"):
        pl.write_image(volume, folder / name)


def pairs(folder: Path) -> None:
    """Pairs of vertices."""
    _put(folder, handmade.PAIRS)


def weights(folder: Path) -> None:
    """A binding to a cage."""
    pl.write_binding(pl.Cage(BOX), pl.Cage(BOX).bind(SHAPE), folder / "cage.npz")


def parts(folder: Path) -> None:
    """A block, as STEP and as IGES."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    block = pl.cad.Part(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape())
    for name in ("block.step", "block.iges"):
        pl.cad.write(block, folder / name)


KINDS: tuple[Callable[[Path], None], ...] = (
    meshes, transforms, models, projects, landmarks, recipes, sequences, images, pairs, weights, parts,
)  # fmt: skip


@cache
def corpus() -> dict[str, bytes]:
    """The files of the corpus, by kind and name: "meshes/a.obj"; files that belong to another are left out."""
    found = (path for path in sorted(CORPUS.rglob("*")) if path.is_file() and path.parent.parent == CORPUS)
    return {path.relative_to(CORPUS).as_posix(): path.read_bytes() for path in found}


def write(folder: Path) -> None:
    """Make all files in a folder."""
    for kind in KINDS:
        place = folder / kind.__name__
        place.mkdir(parents=True)
        kind(place)


def _put(folder: Path, contents: dict[str, bytes]) -> None:
    for name, data in contents.items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    shutil.rmtree(CORPUS, ignore_errors=True)
    write(CORPUS)
