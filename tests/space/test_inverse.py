"""The inverse as a deformer: it undoes, and differentiates."""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.inverse import Inverse
from pliant.testing import check_deformer

POINTS = np.random.default_rng(5).normal(size=(15, 3))
MAP = Affine.of([[1.2, 0.1, 0], [0, 0.9, 0.2], [0.1, 0, 1.1]], [1, -2, 0.5])


def test_undoes_in_both_orders():
    back = Inverse(MAP)
    assert np.allclose(back(MAP(POINTS)), POINTS, atol=1e-12)
    assert np.allclose(MAP(back(POINTS)), POINTS, atol=1e-12)
    assert np.allclose(back.inverse(POINTS), MAP(POINTS))
    assert np.allclose(Inverse(back)(POINTS), MAP(POINTS))


def test_obeys_the_laws_of_deformers():
    lattice = BSplineFFD.around(POINTS, shape=(4, 5, 4), margin=0.2)
    lattice = lattice.moved(lattice.rest + 0.05 * np.random.default_rng(2).normal(size=lattice.rest.shape))
    check_deformer(Inverse(lattice), POINTS)


def test_rest_is_the_identity_exactly():
    assert (Inverse(MAP.moved(MAP.rest))(POINTS) == POINTS).all()


def test_derivatives_agree_with_differences():
    bound = Inverse(MAP).bind(POINTS)
    rng = np.random.default_rng(1)
    step, gradient, h = rng.normal(size=12), rng.normal(size=POINTS.shape), 1e-6
    difference = (bound.deform(MAP.controls + h * step) - bound.deform(MAP.controls - h * step)) / (2 * h)
    assert np.allclose(bound.jvp(None, step), difference, atol=1e-7)
    assert np.isclose((bound.jvp(None, step) * gradient).sum(), step @ bound.vjp(None, gradient))
    assert np.allclose(Inverse(MAP).jacobian(POINTS), np.linalg.inv(MAP.linear))


def test_normals_go_there_and_back():
    mesh = PolygonMesh(POINTS[:3], [[0, 1, 2]])
    mesh = mesh.replace(vertex_attributes={"normals": mesh.vertex_normals})
    again = Inverse(MAP)(MAP(mesh))
    assert np.allclose(again.vertex_attributes["normals"], mesh.vertex_normals, atol=1e-12)
