"""One deformer of every kind, away from rest."""

from __future__ import annotations

import numpy as np
from scene_shapes import GOAL, HANDLE, MESH, ROI, lattice

import pliant as pl
from pliant.deformer import Deformer
from pliant.shape.conditioned_model import ConditionedModel
from pliant.space.summed import Summed


def _disturbed(deformer: Deformer, size: float = 0.05) -> Deformer:
    rest = deformer.rest
    return deformer.moved(rest + np.random.default_rng(3).normal(size=rest.shape) * size)


def _box_around(mesh: pl.PolygonMesh) -> pl.PolygonMesh:
    """A closed box of triangles that encloses a mesh."""
    from scipy.spatial import ConvexHull

    low, high = mesh.bounds
    corners = np.stack(np.meshgrid(*zip(low - 0.2, high + 0.2, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
    hull = ConvexHull(corners)
    a, b, c = (corners[hull.simplices[:, i]] for i in range(3))
    outwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) > 0
    return pl.PolygonMesh(corners, np.where(outwards[:, None], hull.simplices, hull.simplices[:, ::-1]))


def every_deformer() -> dict[str, Deformer]:
    """Deformers by a name that begins with the name of their kind."""
    few = MESH.points[::23]
    kernel = pl.GaussianKernel(sigma=3.0, scale=0.1) + pl.BSplineKernel(support=8.0, scale=0.05)
    model = pl.ShapeModel.from_kernel(MESH, kernel, rank=12)
    low, high = MESH.bounds
    grid = {"origin": low, "spacing": (high - low) / 4}
    field = pl.GaussianProcess(kernel).posterior(few, few + 0.01, noise=0.01).deformer()
    return {
        "affine": pl.Affine.rotation([1, 2, 3], 0.4),
        "arap": pl.ARAP(ROI, HANDLE, goal=GOAL, smoothness=0.01),
        "bend": pl.Bend.around(MESH, axis="x", angle=0.4, center=1.0),
        "bezier-ffd": _disturbed(pl.BezierFFD.around(MESH, shape=(3, 3, 4))),
        "bezier-ffd patches": _disturbed(pl.BezierFFD.around(MESH, patches=(2, 1, 2))),
        "bezier-patch-ffd": _disturbed(pl.BezierPatchFFD.around(MESH, axis="y")),
        "bspline-ffd": lattice(),
        "bspline-ffd planar": _disturbed(pl.BSplineFFD.around(MESH, shape=(3, 4, 1), edge="zero")),
        "cage": _disturbed(pl.Cage(_box_around(MESH))),
        "clamped-ffd": _disturbed(pl.ClampedFFD.around(MESH, shape=(3, 4, 5))),
        "composition": pl.compose(lattice(), pl.Twist.around(MESH, angle=0.4)),
        "dirichlet-ffd": _disturbed(pl.DirichletFFD(few, smooth=True)),
        "displacement-grid": pl.DisplacementGrid(displacements=np.full((5, 5, 5, 3), 0.1), **grid, rim=0.5),
        "extended-ffd": _disturbed(pl.ExtendedFFD.cylinder(MESH)),
        "face-caricature": pl.FaceCaricature(pl.mean_face().points * [1.0, 1.1, 1.0], 0.5, nose=1.5),
        "face-handles": _disturbed(pl.FaceHandles(pl.mean_face().points)),
        "flare": pl.Flare.around(MESH, start=0.5, end=1.4, bulge=0.2),
        "inverse": pl.Inverse(pl.Twist.around(MESH, angle=0.4)),
        "laplacian-edit": pl.LaplacianEdit(ROI, HANDLE, goal=GOAL, pull=np.full(len(HANDLE), 2.0), method="naive"),
        "laplacian-edit at rest": pl.LaplacianEdit(ROI, HANDLE),
        "conditioned-model": ConditionedModel(model, np.linspace(-1, 1, model.count), [3], MESH.points[[3]] + 0.1),
        "model-deformer": model.deformer(np.linspace(-1, 1, model.count)),
        "model-deformer surface": pl.ShapeModel.from_kernel(MESH, kernel, rank=9).deformer(interpolation="surface"),
        "placed": pl.place(lattice(), pl.Affine.translation([0.1, 0, 0.2])),
        "radial-basis-warp": pl.RadialBasisWarp(few, few + 0.1, support=3.0),
        "random-field": field,
        "scale": pl.Scale(x=1.2, y=0.7, origin=(0, 0, 1)),
        "shape-keys": pl.ShapeKeys(np.full((2, len(MESH.points), 3), 0.1), ("up", "down"), [0.5, 1.0]),
        "sine": pl.Sine.around(MESH, amplitude=0.1, waves=2, normal="x"),
        "skeleton-edit": pl.SkeletonEdit(ROI, HANDLE, goal=GOAL, scalar=MESH.points[:, 2]),
        "squash": pl.Squash.around(MESH, factor=0.7),
        "summed": Summed((lattice(), pl.Taper.around(MESH, factor=0.7))),
        "tangent-frames": pl.TangentFrames.around(MESH, rates=np.full((3, 4), 0.1)),
        "taper": pl.Taper.around(MESH, factor=0.7, profile="bump", axis=[0.0, 1.0, 1.0]),
        "thin-plate-spline": pl.ThinPlateSpline(few, few + 0.1, regularization=0.1),
        "twist": pl.Twist.around(MESH, angle=0.5, profile=[(0, 0), (0.5, 1), (1, 0.2)]),
        "wave": pl.Wave.around(MESH, amplitude=0.1, phase=1.0, profile=0.5),
    }
