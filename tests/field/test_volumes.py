from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidMesh
from pliant.field.volumes import volume
from pliant.mesh import PolygonMesh

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def cube(size: float = 1.0) -> PolygonMesh:
    return PolygonMesh(CORNERS * size, QUADS)


def naive(mesh: PolygonMesh) -> float:
    """The same volume as a fan of tetrahedra about each polygon's mean, corner by corner."""
    total = 0.0
    for face in mesh.faces:
        corners = mesh.points[face]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            total += np.linalg.det([corners.mean(axis=0), a, b]) / 6
    return total


def test_a_cube_of_quadrangles():
    assert volume(cube(2.0)) == pytest.approx(8.0, rel=1e-15)
    assert volume(PolygonMesh(CORNERS, [face[::-1] for face in QUADS])) == pytest.approx(-1.0, rel=1e-15)


def test_far_from_the_origin_no_digits_are_lost():
    far = cube().with_points(CORNERS + np.array([1e8, -2e8, 3e8]))
    assert volume(far) == pytest.approx(1.0, rel=1e-12)


def test_a_concave_prism():
    arrow = np.array([[0, 0], [2, 1], [0, 2], [1, 1]], float)  # area 1
    points = np.vstack([np.column_stack([arrow, np.full(4, z)]) for z in (0.0, 3.0)])
    sides = [[i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4] for i in range(4)]
    area = 0.5 * abs(np.dot(arrow[:, 0], np.roll(arrow[:, 1], -1)) - np.dot(arrow[:, 1], np.roll(arrow[:, 0], -1)))
    prism = PolygonMesh(points, [[3, 2, 1, 0], [4, 5, 6, 7], *sides])
    assert volume(prism) == pytest.approx(3.0 * area, rel=1e-14)


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=30)
def test_bent_quadrangles_agree_with_the_naive_fan_and_with_bilinear_patches(seed):
    rng = np.random.default_rng(seed)
    bent = cube().with_points(CORNERS + 0.2 * rng.normal(size=(8, 3)))
    assert volume(bent) == pytest.approx(naive(bent), rel=1e-12)
    halves = [
        sum(np.linalg.det(bent.points[list(t)]) for face in QUADS for t in cut(face)) / 6
        for cut in (
            lambda f: ((f[0], f[1], f[2]), (f[0], f[2], f[3])),
            lambda f: ((f[1], f[2], f[3]), (f[1], f[3], f[0])),
        )
    ]
    assert volume(bent) == pytest.approx(np.mean(halves), rel=1e-12)  # the trilinear hexahedron's volume


@given(seed=st.integers(0, 10_000), axis=st.integers(0, 2))
@settings(deadline=None, max_examples=20)
def test_volume_is_linear_in_each_coordinate(seed, axis):
    rng = np.random.default_rng(seed)
    step = np.zeros((8, 3))
    step[:, axis] = rng.normal(size=8)
    volumes = [volume(cube().with_points(CORNERS + t * step)) for t in (0.0, 1.0, 2.5)]
    assert volumes[2] - volumes[0] == pytest.approx(2.5 * (volumes[1] - volumes[0]), abs=1e-12)


def test_two_cubes_that_touch_along_an_edge():
    both = PolygonMesh(
        np.vstack([CORNERS, CORNERS + np.array([1, 1, 0])]), [*QUADS, *([at + 8 for at in face] for face in QUADS)]
    )
    glue = np.arange(16)
    glue[8], glue[9] = 6, 7  # they share the edge x = y = 1
    glued = PolygonMesh(both.points, [glue[face] for face in both.faces])
    assert volume(glued) == pytest.approx(2.0, rel=1e-14)


def test_no_faces_no_volume():
    assert volume(PolygonMesh(np.empty((0, 3)))) == 0.0
    assert volume(PolygonMesh(CORNERS)) == 0.0


def test_an_open_mesh_is_refused_with_the_count_of_its_boundary_edges():
    with pytest.raises(InvalidMesh, match="open: 4 boundary edges"):
        volume(PolygonMesh(CORNERS, QUADS[1:]))


def test_faces_that_disagree_are_refused():
    with pytest.raises(InvalidMesh, match="disagree about the outside along 4 edges"):
        volume(PolygonMesh(CORNERS, [QUADS[0][::-1], *QUADS[1:]]))
