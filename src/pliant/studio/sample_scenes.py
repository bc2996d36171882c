"""Scenes to try modes on: shapes with layers, made on the spot, and the mode in which each is shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pliant.mesh import PolygonMesh
from pliant.scene.scene import Scene
from pliant.shape.kernels import GaussianKernel
from pliant.shape.model import ShapeModel
from pliant.studio.faces import example_photograph, face_scene
from pliant.studio.samples import egg
from pliant.studio.shape_models import model_scene


@dataclass(frozen=True)
class SampleScene:
    """A scene on the start page.

    Parameters
    ----------
    title
        What it is called.
    points
        How many its shape has.
    make
        What makes it.
    mode
        The mode that it is for.
    there
        Whether what it takes is installed.
    """

    title: str
    points: int
    make: Callable[[], Scene]
    mode: str
    there: Callable[[], bool] = lambda: True


def varying_head() -> Scene:
    """A head that varies smoothly: a shape model from a kernel."""
    full = egg()
    mesh = PolygonMesh(full.points, full.faces)
    kernel = GaussianKernel(sigma=0.3 * mesh.diagonal, scale=0.05 * mesh.diagonal)
    return model_scene(ShapeModel.from_kernel(mesh, kernel, rank=40))


def astronaut() -> Scene:
    """A face, from the portrait that scikit-image carries."""
    photograph = example_photograph()
    assert photograph is not None  # it is offered only where it is there
    return face_scene(photograph)[0]


SCENES = {
    "varying-head": SampleScene("Varying head", 72 * 48, varying_head, "model"),
    "astronaut": SampleScene("Astronaut", 6990, astronaut, "face", lambda: example_photograph() is not None),
}
