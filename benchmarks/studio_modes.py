"""What one move costs the server in each mode of the studio, in one session without a page.

    python benchmarks/studio_modes.py [WORD ...]

A word of a line's name chooses lines. Times are of the processor, medians; the goal is a number of updates a second.
"""

import sys
import time

import numpy as np

import pliant.studio.commands  # noqa: F401
from pliant.cages.boxes import cage_from_box
from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.shape.conditioned_model import ConditionedModel
from pliant.shape.kernels import GaussianKernel
from pliant.shape.model import ShapeModel
from pliant.space.bend import Bend
from pliant.space.cage import Cage
from pliant.studio.examples.samples import torus
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session
from pliant.surface.arap import ARAP
from pliant.surface.laplacian_edit import LaplacianEdit

MOVES = 40


class Page:
    """A page that only counts what it is sent."""

    def __init__(self):
        self.last = 0

    def send(self, data):
        self.last = len(data)


def dragged(scene, begin, moves, prefix):
    """Median milliseconds of a move, and its bytes; ``moves`` gives the values and arrays of each."""
    session, page = Session(scene, "shape"), Page()
    session.submit(lambda: None).result()  # one BLAS thread from now on
    session.clients.append(page)
    cost, sent = [], []

    def run():
        session.handle(page, Frame({"id": 0, "do": f"{prefix}.begin", "with": begin}).encode())
        for number, (values, arrays) in enumerate(moves):
            data = Frame({"id": number, "do": f"{prefix}.move", "with": values}, arrays).encode()
            began = time.process_time()
            session.handle(page, data)
            cost.append(1000 * (time.process_time() - began))
            sent.append(page.last)

    session.submit(run).result()
    session.end()
    return float(np.median(cost[5:])), float(np.median(sent[5:]))


def posterior():
    """A landmark of a model of rank 100 on 50k vertices."""
    mesh = torus(268, 187)
    model = ShapeModel.from_kernel(mesh, GaussianKernel(sigma=0.9, scale=0.15), rank=100)
    chosen = np.array([10, 9000, 18000, 27000, 36000, 45000])
    scene = Scene(mesh, Stack((Layer("Shape model", ConditionedModel(model, vertices=chosen)),)))
    moves = [
        ({}, {"index": np.array([0], np.uint32), "positions": model.mean[10] + [0, 0, 0.005 * step]})
        for step in range(MOVES)
    ]
    return dragged(scene, {"layer": "Shape model"}, moves, "model")


def caged(chosen, coordinates="mean_value"):
    """Vertices of a cage of 152 around 200k points."""
    mesh = torus(640, 313)
    cage = Cage(cage_from_box(mesh, (5, 5, 5)), coordinates=coordinates)
    index = np.arange(chosen, dtype=np.uint32)
    moves = [({}, {"index": index, "positions": cage.rest[index] + [0, 0, 0.005 * step]}) for step in range(MOVES)]
    return dragged(Scene(mesh, Stack((Layer("Cage", cage),))), {"layer": "Cage"}, moves, "drag")


def bent():
    """The angle of a bend on 200k points, by its handle on the canvas."""
    mesh = torus(640, 313)
    bend = Bend.around(mesh, axis="y")
    eye = np.array([0.0, -9.0, 4.0])
    rays = [np.array([-1.2, 0.0, 0.02 * step]) - eye for step in range(MOVES)]
    moves = [({"ray": [*eye.tolist(), *ray.tolist()], "snap": False}, {}) for ray in rays]
    return dragged(Scene(mesh, Stack((Layer("Bend", bend),))), {"layer": "Bend", "handle": "angle"}, moves, "axial")


def edited(method, around, across):
    """A handle at one side of a ring whose region is nearly all of it; turned and shifted by the gizmo."""
    mesh = torus(around, across)
    x = mesh.points[:, 0]
    edit = {"arap": ARAP, "laplacian": LaplacianEdit}[method](np.flatnonzero(x > -1.25), np.flatnonzero(x > 1.2))
    moves = []
    for step in range(MOVES):
        angle, matrix = 0.02 * step, np.eye(4)
        matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        matrix[2, 3] = 0.01 * step
        moves.append(({}, {"matrix": matrix.T.reshape(-1)}))
    return dragged(Scene(mesh, Stack((Layer("Edit", edit),))), {"layer": "Edit", "method": method}, moves, "surface")


LINES = {
    "arap: 35k vertices, by the gizmo": (lambda: edited("arap", 268, 131), 20),
    "laplacian: a region of 100k, by the gizmo": (lambda: edited("laplacian", 456, 225), 10),
    "cage: 152 vertices, 200k points, one moved": (lambda: caged(1), 30),
    "cage: 152 vertices, 200k points, a quarter moved": (lambda: caged(38), 30),
    "cage: the same by Green coordinates, one moved": (lambda: caged(1, "green"), 30),
    "bend: 200k points, by its handle": (bent, 20),
    "posterior: rank 100, 50k vertices, 6 landmarks": (posterior, 30),
}


def main(words):
    print("| drag | server CPU, ms | updates a second | kB | goal |\n|---|--:|--:|--:|--:|")
    for name, (measure, goal) in LINES.items():
        if words and not any(word in name for word in words):
            continue
        cost, sent = measure()
        print(f"| {name} | {cost:.2f} | {1000 / cost:.0f} | {sent / 1000:.0f} | {goal} |")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
