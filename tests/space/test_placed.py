"""A deformer in a frame of its own: conjugation, and the derivatives that follow."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import InvalidDeformer
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


def test_only_a_new_relative_placement_is_bound_anew():
    lattice = BSplineFFD.around(POINTS, shape=(4, 4, 4), margin=0.2)
    lattice = lattice.moved(lattice.rest + 0.05)
    tool = place(lattice, FRAME)
    bound = tool.bind(POINTS)
    ride = Affine.rotation([1, 0, 2], 0.4) @ Affine.translation([5, 0, 0])
    together = bound.at(ride @ FRAME, ride(POINTS))
    assert together._inner is bound._inner
    assert np.allclose(together.deform(), ride(tool(POINTS)), atol=1e-12)
    over = bound.at(ride @ FRAME)
    assert over._inner is not bound._inner
    assert np.allclose(over.deform(), tool.at(ride @ FRAME)(POINTS), atol=1e-12)
    fewer = bound.at(FRAME, POINTS[:4])
    assert np.allclose(fewer.deform(), tool(POINTS[:4]), atol=1e-12)


def test_the_object_through_the_tool_is_the_tool_over_the_object_carried():
    lattice = BSplineFFD.around(POINTS, shape=(4, 4, 4))
    tool = lattice.moved(lattice.rest * 1.1)
    ride = Affine.translation([0.3, 0, 0])
    through = tool(ride(POINTS))
    assert np.allclose(through, ride(place(tool, ride.inverted())(POINTS)), atol=1e-12)


def test_only_maps_of_space_are_placed():
    with pytest.raises(InvalidDeformer, match="no map of space"):
        place("smooth", FRAME)
