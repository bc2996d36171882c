"""Decimated models, and models inside tetrahedra."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidMesh, InvalidParameter
from pliant.shape.correspondence import Target
from pliant.shape.tetrahedra import surrounding


def test_a_decimated_model_is_the_marginal_of_vertices_on_a_closed_surface(soft):
    small = soft.decimated(120)
    kept = np.array([np.flatnonzero((soft.reference.points == p).all(axis=1))[0] for p in small.reference.points])
    given = np.random.default_rng(0).normal(size=soft.count)
    np.testing.assert_array_equal(small.instance(given), soft.instance(given)[kept])
    mesh = small.reference
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 2).all()
    assert len(mesh.points) - len(unique) + len(mesh.triangles) == 2  # Euler: a sphere
    away = Target(mesh, np.pi).closest(soft.reference.points) - soft.reference.points
    assert np.linalg.norm(away, axis=1).mean() < 0.06
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    assert np.einsum("ti,ti->", np.cross(a, b), c) > 0  # faces still look outwards
    with pytest.raises(InvalidParameter, match="to 4 of them"):
        soft.decimated(3)
    with pytest.raises(InvalidMesh, match="without faces"):
        pl.ShapeModel.from_kernel(pl.PolygonMesh(mesh.points), pl.GaussianKernel(9, 1), rank=2).decimated(5)


def test_points_in_tetrahedra_follow_linear_fields(random):
    from scipy.spatial import Delaunay

    points = random.normal(size=(60, 3))
    cells = Delaunay(points).simplices.astype(np.int32)
    inside = np.einsum("mc,mcd->md", random.dirichlet(np.ones(4), 50), points[cells[:50]])
    corners, weights = surrounding(points, cells, inside)
    assert weights.min() >= 0
    np.testing.assert_allclose(np.einsum("mc,mcd->md", weights, points[corners]), inside, atol=1e-9)
    linear = random.normal(size=(3, 3))
    reference = pl.PolygonMesh(points)
    kernel_free = pl.learn_model([reference, reference.with_points(points @ linear)], align=False)
    model = pl.ShapeModel(reference, kernel_free.mean, kernel_free.basis, cells=cells)
    given = np.array([0.7])
    moved = model.deformer(given, interpolation="tetrahedra")(inside)
    shape = model.instance(given)
    expected = np.linalg.lstsq(np.c_[points, np.ones(60)], shape, rcond=None)[0]
    np.testing.assert_allclose(moved, np.c_[inside, np.ones(50)] @ expected, atol=1e-9)
    far = model.deformer(given, interpolation="tetrahedra")(np.array([[50.0, 0, 0]]))
    assert np.isfinite(far).all()
    with pytest.raises(InvalidParameter, match="no tetrahedra"):
        kernel_free.deformer(given, interpolation="tetrahedra")(inside)
