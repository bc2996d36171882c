"""Scenes to try modes on: shapes with layers, made on the spot, and the mode in which each is shown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pliant.cages.boxes import cage_from_box
from pliant.mesh import PolygonMesh
from pliant.scene.clip import Clip
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.kernels import GaussianKernel
from pliant.shape.model import ShapeModel
from pliant.shape.surface_samples import surface_samples
from pliant.space.affine import Affine
from pliant.space.bend import Bend
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.cage import Cage
from pliant.space.dirichlet_ffd import DirichletFFD
from pliant.space.twist import Twist
from pliant.studio.examples.samples import bar, column, egg, textured_vase, torus
from pliant.studio.examples.transfer_sample import arm, posed_bar
from pliant.studio.modes.faces import example_photograph, face_scene
from pliant.studio.modes.shape_models import model_scene
from pliant.surface.arap import ARAP
from pliant.surface.shape_keys import ShapeKeys
from pliant.surface.transfer import DeformationTransfer


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


def bent_bar() -> Scene:
    """A bar that is twisted, then bent: two layers along its axis."""
    mesh = bar()
    twist = Twist.around(mesh, axis="x", angle=math.pi / 2, profile="smooth")
    bend = Bend.around(mesh, axis="y", angle=0.6 * math.pi)
    return Scene(mesh, Stack((Layer("Twist", twist), Layer("Bend", bend))))


def sited_egg() -> Scene:
    """An egg with sites all over it, one of them pulled."""
    mesh = egg()
    sites = DirichletFFD(surface_samples(mesh, 30, "farthest"), smooth=True)
    controls = np.array(sites.rest)
    controls[int(np.argmin(controls[:, 1] + abs(controls[:, 2])))] += [0.0, -0.35, 0.1]
    return Scene(mesh, Stack((Layer("Sites", sites.moved(controls)),)))


def caged_vase() -> Scene:
    """A vase in a box of four storeys, the upper ones leaning."""
    mesh = textured_vase()
    cage = Cage(cage_from_box(mesh, (1, 1, 4), 0.03))
    height = (cage.rest[:, 2] - mesh.bounds[0][2]) / (mesh.bounds[1][2] - mesh.bounds[0][2])
    lean = np.clip(height - 0.4, 0.0, None) ** 2
    controls = cage.rest + mesh.diagonal * lean[:, None] * [0.55, 0.0, 0.0]
    return Scene(mesh, Stack((Layer("Cage", cage.moved(controls)),)))


def raised_arm() -> Scene:
    """An arm whose hand is raised, as rigid as possible; region and hand are named selections."""
    mesh = arm()
    region, hand = (np.flatnonzero(mesh.points[:, 0] > start) for start in (-0.9, 1.45))
    angle = 0.9
    turn = np.array([[math.cos(angle), 0, -math.sin(angle)], [0, 1, 0], [math.sin(angle), 0, math.cos(angle)]])
    goal = (mesh.points[hand] - [0.4, 0, 0]) @ turn.T + [0.3, 0, 0.25]
    edit = Layer("Edit", ARAP(region, hand, goal=goal))
    return Scene(mesh, Stack((edit,)), selections={"arm": region, "hand": hand})


def posed_arm() -> Scene:
    """An arm in the poses of a bar, as shape keys."""
    mesh = arm()
    bench = posed_bar(mesh)
    clone = DeformationTransfer(bench.source, mesh, np.array(bench.markers))
    moves = np.stack([clone.points(pose) - mesh.points for pose in bench.poses.values()])
    return Scene(mesh, Stack((Layer("Poses", ShapeKeys(moves, tuple(bench.poses), [1.0, 0.0, 0.0])),)))


def torus_in_lattice() -> Scene:
    """A torus in a lattice of which a corner has been pulled."""
    mesh = torus()
    lattice = BSplineFFD.around(mesh, shape=(5, 5, 3), margin=0.08)
    controls = np.array(lattice.rest)
    controls[4, 3, 2] += [0.45, 0.3, 0.55]
    return Scene(mesh, Stack((Layer("Lattice", lattice.moved(controls)),)))


def soft_head() -> Scene:
    """A head in a fine lattice at rest, to be pulled anywhere."""
    mesh = egg()
    return Scene(mesh, Stack((Layer("Lattice", BSplineFFD.around(mesh, shape=(8, 8, 8), margin=0.05)),)))


def swallowing_column() -> Scene:
    """A column that sways while a bulge climbs through it: a tool that moves over the object, and a bend with keys."""
    mesh = column()
    box = np.array([[-0.75, -0.75, -2.0], [0.75, 0.75, -0.8]])
    lattice = BSplineFFD.around(box, shape=(5, 5, 5))
    controls = np.array(lattice.rest)
    middle = controls[1:4, 1:4, 1:4]
    middle[..., :2] *= 2.1
    bulge = Layer("Bulge", lattice.moved(controls))
    sway = Layer("Sway", Bend.around(mesh, axis="y", normal="x", angle=0.0, center=0.0))
    stack = Stack((bulge, sway))
    clip = Clip(mesh, stack, duration=2.4, fps=24.0, ending="loop")
    for time, lift in ((0.0, 0.0), (2.4, 6.8)):
        clip = clip.key("Bulge", time, {"frame": Affine.translation([0.0, 0.0, lift])}, easing=(0.3, 0.1, 0.7, 0.9))
    for time, angle in ((0.0, 0.0), (0.6, 0.5), (1.8, -0.5), (2.4, 0.0)):
        clip = clip.key("Sway", time, {"angle": angle}, easing="smooth")
    return Scene(mesh, stack, clip)


SCENES = {
    "torus-in-lattice": SampleScene("Torus in a lattice", 96 * 40, torus_in_lattice, "points"),
    "soft-head": SampleScene("Soft head", 72 * 48, soft_head, "pull"),
    "raised-arm": SampleScene("Raised arm", 1234, raised_arm, "surface"),
    "posed-arm": SampleScene("Arm with poses", 1234, posed_arm, "transfer"),
    "bent-bar": SampleScene("Bent bar", 2440, bent_bar, "axial"),
    "sited-egg": SampleScene("Egg with sites", 3456, sited_egg, "sites"),
    "caged-vase": SampleScene("Caged vase", 13920, caged_vase, "cage"),
    "varying-head": SampleScene("Varying head", 72 * 48, varying_head, "model"),
    "swallowing-column": SampleScene("Swallowing column", 97 * 40, swallowing_column, "time"),
    "astronaut": SampleScene("Astronaut", 6990, astronaut, "face", lambda: example_photograph() is not None),
}
