"""What is no number, no shape and no frame is refused by name, whatever asks for it."""

import numpy as np
import pytest

import pliant as pl
from pliant import shapes
from pliant.errors import InvalidControls, InvalidDeformer, InvalidMesh, InvalidParameter

POINTS = np.random.default_rng(0).normal(size=(20, 3))


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pl.BSplineFFD.around(POINTS, shape="abc"), InvalidDeformer, "whole numbers of control points"),
        (lambda: pl.BSplineFFD.around(POINTS, shape=(4, 4, 2.5)), InvalidDeformer, "whole numbers of control points"),
        (lambda: pl.BSplineFFD.around(POINTS, shape=(4, 4)), InvalidDeformer, "at least one control point an axis"),
        (lambda: pl.BSplineFFD.around(POINTS, margin="wide"), InvalidDeformer, "margin is 'wide'"),
        (lambda: pl.BSplineFFD.around(POINTS, margin=-0.5), InvalidDeformer, "nothing would be left"),
        (
            lambda: pl.BSplineFFD(displacements="a", origin=(0, 0, 0), spacing=(1, 1, 1)),
            InvalidDeformer,
            "displacements is 'a'",
        ),
        (lambda: pl.BezierFFD.around(POINTS, patches=(1, 1)), InvalidDeformer, "at least one control point an axis"),
        (lambda: pl.BezierFFD.around(POINTS, patches="abc"), InvalidDeformer, "whole numbers of control points"),
        (lambda: pl.BezierFFD.around(POINTS, margin=np.inf), InvalidDeformer, "margin is inf"),
        (lambda: pl.BezierPatchFFD.around(POINTS, shape=(3, 1)), InvalidDeformer, "two control points or more"),
        (lambda: pl.Affine.rotation("z", "far"), InvalidDeformer, "angle is 'far'"),
        (lambda: pl.Affine.rotation("z", 10**400), InvalidDeformer, "angle is 1000"),
        (lambda: pl.Affine.translation("abc"), InvalidDeformer, "offset is 'abc'"),
        (lambda: pl.place(pl.Affine(), np.eye(4)), InvalidDeformer, "a frame is an Affine, not a ndarray"),
        (lambda: pl.Affine()(["abc"]), InvalidMesh, "numbers are needed"),
        (lambda: pl.Affine().moved("abc"), InvalidControls, "controls is 'abc'"),
        (lambda: pl.certify(pl.Affine(), budget="all"), InvalidParameter, "budget is 'all'"),
        (lambda: pl.arrows(pl.Affine(), ("low", "high"), 0.1), InvalidParameter, "bounds is"),
        (lambda: pl.align(POINTS, POINTS, weights="even"), InvalidParameter, "weights is 'even'"),
        (lambda: shapes.sphere(1.0, "here"), InvalidParameter, "the center is 'here'"),
        (lambda: shapes.sphere(1.0, segments="many"), InvalidParameter, "segments is 'many'"),
        (lambda: shapes.cone(top="sharp"), InvalidParameter, "top is 'sharp'"),
    ],
)
def test_it_is_refused_by_name(make, error, words):
    with pytest.raises(error, match=words):
        make()


MESH = shapes.sphere(1.0, segments=16).mesh
STACK = pl.Stack([pl.Layer("a", pl.Affine())])


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pl.Clip(MESH, STACK, duration="long"), InvalidParameter, "duration is 'long'"),
        (lambda: pl.Clip(MESH, STACK, fps=None), InvalidParameter, "fps is None"),
        (lambda: pl.Clip(MESH, STACK, intensity="full"), InvalidParameter, "intensity is 'full'"),
        (lambda: pl.Clip(MESH, STACK, ending="loop").sample(np.nan), InvalidParameter, "the time is nan"),
        (lambda: pl.Clip(MESH, STACK).key("a", 0.0, {"envelope": 1.0}, easing=3), InvalidParameter, "3 is no easing"),
        (lambda: pl.ARAP([0, 1, 2], [0], iterations="many"), InvalidDeformer, "iterations is 'many'"),
        (lambda: pl.ARAP([0, 1, 2], [0], tolerance=None), InvalidDeformer, "tolerance is None"),
        (lambda: pl.LaplacianEdit([0, 1, 2], [0], pull="hard"), InvalidDeformer, "pull is 'hard'"),
        (lambda: pl.smooth(MESH, 2.5), InvalidParameter, "iterations is 2.5; a whole number"),
        (lambda: pl.smooth(MESH, 3, strength="much"), InvalidParameter, "strength is 'much'"),
        (lambda: pl.smooth(MESH, -1), InvalidParameter, "iterations is -1; it must be 0 or more"),
        (lambda: pl.ThinPlateSpline(POINTS, regularization="some"), InvalidDeformer, "regularization is 'some'"),
        (lambda: pl.DirichletFFD("sites"), InvalidDeformer, "sites is 'sites'"),
        (
            lambda: pl.ShapeModel.from_kernel(MESH, pl.GaussianKernel(1.0), rank=2.5),
            InvalidParameter,
            "the rank is 2.5",
        ),
        (lambda: pl.contour_skeleton(MESH, "x"), InvalidParameter, "contours is 'x'; a whole number"),
        (lambda: pl.Landmarks(["a"], [[0.0, 1.0]]), InvalidParameter, r"\(k, 3\) is needed"),
    ],
)
def test_numbers_of_scenes_surfaces_and_models_are_looked_at_first(make, error, words):
    with pytest.raises(error, match=words):
        make()
