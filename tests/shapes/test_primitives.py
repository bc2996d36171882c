"""Primitives: closed, outwards, on their surfaces, and of the volume that they converge to."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import beta

import pliant as pl
from pliant.errors import InvalidMesh, InvalidParameter

shapes = pl.shapes
ALL = {
    "box": (lambda n: shapes.box((1, 2, 3)), 6.0),
    "sphere": (lambda n: shapes.sphere(1.5, segments=n), 4 / 3 * np.pi * 1.5**3),
    "cylinder": (lambda n: shapes.cylinder(0.5, 3, segments=n), np.pi * 0.25 * 3),
    "cone": (lambda n: shapes.cone(0.5, 3, segments=n), np.pi * 0.25),
    "frustum": (lambda n: shapes.cone(2, 3, top=1, segments=n), np.pi * (4 + 2 + 1)),
    "torus": (lambda n: shapes.torus(2, 0.5, segments=n), 2 * np.pi**2 * 2 * 0.25),
}


@pytest.mark.parametrize("name", ALL)
def test_closed_and_of_their_volume(name):
    make, expected = ALL[name]
    misses = []
    for segments in (64, 128):
        mesh = make(segments).mesh
        assert mesh.edge_use == (0, 0)
        assert np.allclose(mesh.center, 0, atol=1e-12)
        misses.append(abs(pl.volume(mesh) - expected) / expected)
    assert misses[0] < 0.03
    assert misses[1] < 1e-12 or misses[0] / misses[1] == pytest.approx(4, rel=0.15)  # of the second order


@pytest.mark.parametrize("exponents", [(1, 1), (0.3, 0.3), (1, 0.2), (2, 2), (0.5, 2.5)])
def test_superquadrics_lie_on_their_surface_and_have_their_volume(exponents):
    e1, e2 = exponents
    mesh = shapes.superquadric((2, 4, 6), exponents, segments=256).mesh
    x, y, z = np.abs(mesh.points).T / np.array([[1], [2], [3]])
    assert np.allclose((x ** (2 / e2) + y ** (2 / e2)) ** (e2 / e1) + z ** (2 / e1), 1)
    assert mesh.edge_use == (0, 0)
    volume = 2 * 1 * 2 * 3 * e1 * e2 * beta(e1 / 2 + 1, e1) * beta(e2 / 2, e2 / 2)
    assert pl.volume(mesh) == pytest.approx(volume, rel=0.01)


def test_a_round_superquadric_is_a_sphere():
    sphere, other = shapes.sphere(1.0, (1, 2, 3)).mesh, shapes.superquadric(2.0, (1, 1), (1, 2, 3), segments=64).mesh
    assert np.allclose(sphere.points, other.points)


@pytest.mark.parametrize(
    ("make", "cause"),
    [
        (lambda: shapes.box((1, -1, 1)), "positive"),
        (lambda: shapes.box((1, 1)), "3 positive lengths"),
        (lambda: shapes.sphere(np.nan), "finite"),
        (lambda: shapes.sphere(1, (0, 0)), "center"),
        (lambda: shapes.cylinder(segments=2), "segments"),
        (lambda: shapes.cone(top=-1), "top"),
        (lambda: shapes.torus(1, 2), "cut itself"),
        (lambda: shapes.superquadric(1, (0, 1)), "between"),
        (lambda: shapes.superquadric(1, 3), "two numbers"),
    ],
)
def test_what_no_primitive_takes(make, cause):
    with pytest.raises(InvalidParameter, match=cause):
        make()


def test_open_meshes_are_no_solids():
    mesh = shapes.box().mesh
    with pytest.raises(InvalidMesh, match="4 edges bound one only"):
        shapes.solid(mesh.replace(faces=[mesh.faces[i] for i in range(5)], groups=None))
    assert shapes.solid(mesh).mesh is mesh
