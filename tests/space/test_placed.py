"""A deformer in a frame of its own: conjugation, and the derivatives that follow."""

from __future__ import annotations

import numpy as np

from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.inverse import Inverse
from pliant.space.placed import place
from pliant.testing import check_deformer

POINTS = np.random.default_rng(6).normal(size=(15, 3))
MAP = Affine.of([[1.2, 0.1, 0], [0, 0.9, 0.2], [0.1, 0, 1.1]], [1, -2, 0.5])
FRAME = Affine.translation([3, 0, 1]) @ Affine.rotation([1, 2, 3], 0.7) @ Affine.scaling([1, 2, 0.5])


def test_is_the_conjugate():
    conjugate = FRAME @ MAP @ FRAME.inverted()
    placed = place(MAP, FRAME)
    assert np.allclose(placed(POINTS), conjugate(POINTS), atol=1e-12)
    assert np.allclose(placed.jacobian(POINTS), conjugate.linear, atol=1e-12)
    assert np.allclose(placed.inverse(placed(POINTS)), POINTS, atol=1e-12)
    assert np.allclose(Inverse(placed)(POINTS), placed.inverse(POINTS))


def test_the_tool_moves_with_its_frame():
    still = Affine.scaling(1.5)
    there = place(still, Affine.translation([10, 0, 0]))
    assert np.allclose(there([[10, 0, 0], [11, 0, 0]]), [[10, 0, 0], [11.5, 0, 0]])


def test_obeys_the_laws_of_deformers():
    lattice = BSplineFFD.around(POINTS, shape=(4, 5, 4), margin=0.2)
    lattice = lattice.moved(lattice.rest + 0.05 * np.random.default_rng(2).normal(size=lattice.rest.shape))
    check_deformer(place(lattice, FRAME), POINTS)


def test_rest_is_the_identity_exactly():
    assert (place(MAP.moved(MAP.rest), FRAME)(POINTS) == POINTS).all()


def test_derivatives_agree_with_differences():
    bound = place(MAP, FRAME).bind(POINTS)
    rng = np.random.default_rng(1)
    step, gradient = rng.normal(size=12), rng.normal(size=POINTS.shape)
    assert np.allclose(bound.jvp(None, step), bound.deform(MAP.controls + step) - bound.deform(), atol=1e-12)
    assert np.isclose((bound.jvp(None, step) * gradient).sum(), step @ bound.vjp(None, gradient))


def test_a_half_turn_carries_normals_exactly():
    mesh = PolygonMesh(POINTS[:3], [[0, 1, 2]])
    mesh = mesh.replace(vertex_attributes={"normals": mesh.vertex_normals})
    turn = Affine.scaling([-1, -1, 1])
    flipped = turn(MAP(turn(mesh)))
    placed = place(MAP, turn)(mesh)
    assert np.allclose(placed.points, flipped.points, atol=1e-14)
    assert np.allclose(placed.vertex_attributes["normals"], flipped.vertex_attributes["normals"], atol=1e-14)
    assert np.allclose(placed.vertex_attributes["normals"], placed.vertex_normals, atol=1e-12)
