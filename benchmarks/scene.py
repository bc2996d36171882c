"""Stacks and projects: `python benchmarks/scene.py`.

What a change in one layer costs, against that layer alone and against the whole stack anew; what a project of a million
vertices costs to save and to load.
"""

from __future__ import annotations

import itertools
import tempfile
from pathlib import Path

import numpy as np

import pliant as pl
from measure import Comparison, report


def torus(along: int = 1000, around: int = 1000) -> pl.PolygonMesh:
    """A torus of quadrangles."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, along, endpoint=False),
        np.linspace(0, 2 * np.pi, around, endpoint=False),
        indexing="ij",
    )
    points = np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    faces = np.stack(
        [(i + a) % along * around + (j + b) % around for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=-1
    )
    return pl.PolygonMesh(points.reshape(-1, 3), faces.reshape(-1, 4))


def lattice(mesh: pl.PolygonMesh, seed: int, size: float = 0.05) -> pl.BSplineFFD:
    """A lattice of 8 x 8 x 8 control points, moved at random."""
    rest = pl.BSplineFFD.around(mesh, shape=(8, 8, 8), margin=0.2)
    return rest.moved(rest.rest + np.random.default_rng(seed).normal(size=rest.rest.shape) * size)


def stack_comparisons(mesh: pl.PolygonMesh) -> list[Comparison]:
    mask = np.clip(mesh.points[:, 0] / 8 + 0.5, 0, 1)
    stack = pl.Stack(
        [
            pl.Layer("warp", lattice(mesh, 1)),
            pl.Layer("twist", pl.Twist.around(mesh, angle=0.5), mask=mask),
            pl.Layer("taper", pl.Taper.around(mesh, axis="x", factor=0.8)),
            pl.Layer("sine", pl.Sine.around(mesh, axis="x", amplitude=0.1), envelope=0.5),
            pl.Layer("top", lattice(mesh, 2)),
        ]
    )
    binding = stack.bind(mesh)
    steps = itertools.count()

    def changed(name: str) -> pl.Stack:
        """The stack with one layer's controls where they have not been before."""
        deformer = stack[name].deformer
        return stack.replace(name, deformer=deformer.moved(deformer.controls * (1 + 1e-6 * (1 + next(steps)))))

    alone = stack["top"].deformer.bind(binding.below("top"))
    drag, controls = binding.drag_layer("warp"), stack["warp"].deformer.controls.copy()

    def dragged() -> None:
        controls[4, 4, 4] += 1e-4
        drag.update(controls, changed=[(4, 4, 4)])

    def only_top() -> None:
        alone.deform(changed("top")["top"].deformer.controls)

    return [
        Comparison(
            "5 layers on 1M points, the top one's controls move",
            {
                "that layer alone, bound": only_top,
                "the stack, updated": lambda: binding.updated(changed("top")).result,
                "the stack, all anew": lambda: changed("top").bind(mesh).result,
            },
        ),
        Comparison(
            "one control point of the lowest layer is dragged",
            {
                "drag_layer": dragged,
                "the stack, updated": lambda: binding.updated(changed("warp")).result,
            },
        ),
    ]


def project_comparisons(mesh: pl.PolygonMesh, folder: Path) -> list[Comparison]:
    stack = pl.Stack([pl.Layer("warp", lattice(mesh, 1), mask=np.ones(len(mesh.points)))])
    scene, path = pl.Scene(mesh, stack), folder / "scene.pliant"
    return [
        Comparison(
            "project of 1M vertices, 1M quadrangles (goal: 1,500 ms to save and to load)",
            {
                "save": lambda: pl.save_project(scene, path),
                "load": lambda: pl.load_project(path),
                "write the mesh as binary PLY": lambda: pl.write(mesh, folder / "mesh.ply"),
                "read it": lambda: pl.read(folder / "mesh.ply"),
            },
            rounds=3,
        )
    ]


if __name__ == "__main__":
    shape = torus()
    with tempfile.TemporaryDirectory() as folder:
        found = [*stack_comparisons(shape), *project_comparisons(shape, Path(folder))]
        print(report("Stacks and projects", found, ["pliant", "numpy"]))
