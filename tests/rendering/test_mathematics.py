"""What pictures rest on: cameras that frame, colours evenly spaced, normals, round numbers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pliant.mesh import CornerValues, PolygonMesh
from pliant.rendering.camera import ANGLE, frame, view_axes
from pliant.rendering.fields import lattice_edges
from pliant.rendering.legend import round_numbers
from pliant.rendering.palette import DIVERGING, SEQUENTIAL, color_table, oklab_to_srgb
from pliant.rendering.quantities import painted, quantity
from pliant.rendering.shading import corner_normals

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


@given(
    seed=st.integers(0, 1000),
    view=st.sampled_from(["iso", "front", "top", "left", (1.0, 2.0, -3.0)]),
    aspect=st.floats(0.4, 3),
    right=st.sampled_from([0.0, 0.13]),
)
@example(seed=137, view="top", aspect=2.0, right=0.0)
@settings(deadline=None, max_examples=60)
def test_the_frame_touches_the_points_and_leaves_the_margins(seed, view, aspect, right):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(30, 3)) * rng.uniform(0.1, 10, 3) + rng.normal(size=3) * 100
    axes = view_axes(view, "z")
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)
    camera = frame(points, axes, aspect, margin=0.07, right=right)
    x, y, depth = axes @ (points - camera.position).T
    half = np.tan(ANGLE / 2) * -depth
    wide, tall = np.abs(x / half / aspect).max(), np.abs(y / half).max()
    assert wide <= (1 - 0.14 - right) * (1 + 1e-6)
    assert tall <= (1 - 0.14) * (1 + 1e-6)
    assert wide >= 0.97 * (1 - 0.14 - right) or tall >= 0.97 * (1 - 0.14)


def test_up_is_up_and_the_front_faces_the_viewer():
    np.testing.assert_allclose(view_axes("front", "z"), [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(view_axes("front", "y"), np.eye(3), atol=1e-15)
    np.testing.assert_allclose(view_axes("right", "z")[0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(view_axes((0, 0, 5.0), "z")[2], [0, 0, 1], atol=1e-15)


def test_oklab_knows_white_black_and_red():
    lab = [[1, 0, 0], [0, 0, 0], [0.627955, 0.224863, 0.125846]]  # Ottosson's table
    np.testing.assert_allclose(oklab_to_srgb(lab), [[1, 1, 1], [0, 0, 0], [1, 0, 0]], atol=2e-3)


def test_colour_maps_get_steadily_darker_away_from_their_pale_end():
    luminance = color_table(SEQUENTIAL) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(luminance) < 1e-4).all()
    both = color_table(DIVERGING, 257) @ [0.2126, 0.7152, 0.0722]
    assert both.argmax() == 128
    assert (np.diff(both[:129]) > -1e-4).all()
    assert (np.diff(both[128:]) < 1e-4).all()


def test_a_quantity_paints_its_ends_and_what_is_beyond():
    mesh = PolygonMesh(CORNERS, QUADS)
    paint = quantity(np.array([-5, 0, 1, 2, 3, 4, 5, 50.0]), mesh, mesh, None, (0, 5))
    colors = painted(paint)
    ends = np.rint(255 * color_table(SEQUENTIAL)[[0, -1]])
    np.testing.assert_array_equal(colors[[0, 1]], ends[[0, 0]])
    np.testing.assert_array_equal(colors[[6, 7]], ends[[1, 1]])


def test_quantities_by_name():
    before = PolygonMesh(CORNERS, QUADS, vertex_attributes={"flow": 3 * CORNERS}, face_attributes={"id": np.arange(6)})
    after = before.with_points(CORNERS + np.array([0, 0, 2]))
    named = {name: quantity(name, before, after, None, None) for name in ("displacement", "z", "flow", "id")}
    np.testing.assert_allclose(named["displacement"].values, 2)
    np.testing.assert_allclose(named["z"].values, CORNERS[:, 2] + 2)
    np.testing.assert_allclose(named["flow"].values, 3 * np.linalg.norm(CORNERS, axis=1))
    assert named["id"].on_faces
    assert (named["z"].low, named["z"].high) == (2, 3)
    assert named["displacement"].low < named["displacement"].high
    unmoved = quantity("volume ratio", before, before, None, None)
    assert unmoved.low + unmoved.high == 2


def test_normals_of_a_cube_stay_on_its_faces_and_those_of_a_fine_cylinder_are_round():
    cube = PolygonMesh(CORNERS, QUADS)
    normals = corner_normals(cube)
    assert (np.sort(np.abs(normals), axis=2) == [0, 0, 1]).all()
    middle = cube.points[cube.triangles].mean(axis=1) - 0.5
    assert (np.einsum("tci,ti->tc", normals, middle) > 0).all()
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.vstack([np.column_stack([ring, np.full(60, z)]) for z in (0.0, 1.0)])
    sides = [[i, (i + 1) % 60, (i + 1) % 60 + 60, i + 60] for i in range(60)]
    tube = PolygonMesh(points, [*sides, list(range(60))[::-1]])
    round_ones = corner_normals(tube)[: 2 * 60]
    expected = np.column_stack([points[:, :2], np.zeros(120)])[tube.triangles[:120]]
    np.testing.assert_allclose(round_ones, expected, atol=1e-12)


def test_seams_of_texture_coordinates_do_not_show_in_normals():
    bent = np.array([[0, 0, 0], [1, 0, 0.1], [2, 0, 0], [0, 1, 0], [1, 1, 0.1], [2, 1, 0]], float)
    faces = [[0, 1, 4, 3], [1, 2, 5, 4]]
    torn = CornerValues(np.zeros((8, 2)), np.arange(8))
    np.testing.assert_array_equal(
        corner_normals(PolygonMesh(bent, faces)), corner_normals(PolygonMesh(bent, faces, uvs=torn))
    )


def test_lattice_edges_join_neighbours_once():
    at = np.stack(np.meshgrid(*map(np.arange, (2, 3, 4)), indexing="ij"), axis=-1).reshape(-1, 3)
    edges = lattice_edges((2, 3, 4))
    assert len(edges) == 1 * 3 * 4 + 2 * 2 * 4 + 2 * 3 * 3
    assert (np.abs(at[edges[:, 0]] - at[edges[:, 1]]).sum(axis=1) == 1).all()
    assert len(np.unique(np.sort(edges, axis=1), axis=0)) == len(edges)


@given(start=st.floats(-1e3, 1e3), extent=st.floats(1e-6, 1e9))
@settings(deadline=None, max_examples=100)
def test_round_numbers_are_few_evenly_spaced_and_inside(start, extent):
    low = start * extent
    numbers = round_numbers(low, low + extent)
    assert 1 <= len(numbers) <= 7
    assert (numbers >= low - 1e-5 * extent).all()
    assert (numbers <= low + extent * (1 + 1e-5)).all()
    if len(numbers) > 1:
        mantissa = np.diff(numbers)[0] / 10 ** np.floor(np.log10(np.diff(numbers)[0] * (1 + 1e-6)))
        assert min(abs(mantissa - each) for each in (1, 2, 5)) < 1e-3
