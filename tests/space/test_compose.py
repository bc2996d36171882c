"""Composition: the chain rule, inverses in reverse order, and a muted part that is not there at all."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import InvalidControls, InvalidDeformer
from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.space.bend import Bend
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import Composition, compose
from pliant.space.taper import Taper
from pliant.space.twist import Twist
from pliant.testing import check_deformer

POINTS = np.random.default_rng(5).uniform(-0.9, 0.9, size=(120, 3)) * [1, 1, 0.3]
WIDE = {"bounds": (-2.0, 2.0)}  # no kinks among the points


@pytest.fixture
def lattice():
    lattice = BSplineFFD.around(POINTS, shape=(4, 4, 4), margin=0.3)
    return lattice.moved(lattice.rest + 0.05 * np.random.default_rng(2).normal(size=lattice.rest.shape))


def test_obeys_the_laws_of_deformers(lattice):
    check_deformer(compose(Bend(angle=0.5, **WIDE), lattice, Twist(angle=0.8, **WIDE)), POINTS)


def test_the_first_is_first(lattice):
    twist = Twist(angle=0.8, **WIDE)
    both = compose(twist, lattice)
    assert (both(POINTS) == lattice(twist(POINTS))).all()
    expected = lattice.jacobian(twist(POINTS)) @ twist.jacobian(POINTS)
    assert np.allclose(both.jacobian(POINTS), expected, atol=1e-14)


def test_affine_maps_compose_as_their_matrices():
    a, b = Affine.rotation("x", 0.3), Affine.translation([1, 2, 3])
    assert np.allclose(compose(a, b)(POINTS), (b @ a)(POINTS), atol=1e-14)


def test_muting_one_gives_exactly_the_other(lattice):
    hat = compose(Bend(angle=0.5, **WIDE), Twist(angle=0.8, **WIDE), lattice)
    for kept in range(3):
        controls = [part.controls if i == kept else part.rest for i, part in enumerate(hat.deformers)]
        flat = np.concatenate([c.reshape(-1) for c in controls])
        expected = hat.deformers[kept](POINTS)
        assert (hat.moved(flat)(POINTS) == expected).all()
        assert (hat.bind(POINTS).deform(flat) == expected).all()


def test_controls_are_those_of_the_parts_one_after_another(lattice):
    both = compose(Twist(angle=0.8), lattice)
    assert both.controls.shape == (1 + lattice.rest.size,)
    assert both.controls[0] == 0.8
    moved = both.moved(np.concatenate([[0.1], both.controls[1:]]))
    assert moved.deformers[0].angle == 0.1
    assert np.allclose(moved.deformers[1].controls, lattice.controls)
    with pytest.raises(InvalidControls):
        both.moved([1.0])


def test_what_lies_before_the_moved_part_is_not_done_again(lattice, monkeypatch):
    both = compose(lattice, Twist(angle=0.8, **WIDE))
    bound = both.bind(POINTS)
    expected = both.moved([*both.controls[:-1], 0.3])(POINTS)
    monkeypatch.setattr(BSplineFFD, "_deformed", None)
    monkeypatch.setattr(type(bound._bindings[0]), "deform", None)
    assert np.abs(bound.deform([*both.controls[:-1], 0.3]) - expected).max() < 1e-14


def test_compositions_are_taken_apart():
    a, b, c = Twist(), Taper(), Bend()
    assert compose(compose(a, b), c).deformers == compose(a, compose(b, c)).deformers == (a, b, c)


def test_stored_normals_follow():
    mesh = PolygonMesh(POINTS[:3], [[0, 1, 2]])
    mesh = mesh.replace(vertex_attributes={"normals": mesh.vertex_normals})
    maps = Affine.of([[1, 0.5, 0], [0, 1, 0.2], [0.3, 0, 2]]), Affine.scaling([1, 2, 3])
    moved = compose(*maps)(mesh)
    assert np.allclose(moved.vertex_attributes["normals"], moved.vertex_normals, atol=1e-12)


def test_what_is_no_map_of_space_is_refused():
    with pytest.raises(InvalidDeformer, match="nothing to compose"):
        compose()
    with pytest.raises(InvalidDeformer, match="deformer 1 is a str"):
        Composition((Twist(), "smooth"))
