import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidMesh, InvalidParameter
from pliant.mesh import CornerValues, FaceLabels, PolygonMesh, as_points


def area(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def star(corners, rng):
    """A simple polygon, concave more often than not: radii over sorted angles."""
    angle = np.sort(rng.random(corners) * 2 * np.pi)
    radius = 0.3 + rng.random(corners)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(corners)])


def shoelace(polygon):
    x, y = polygon[:, 0], polygon[:, 1]
    return (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2


@settings(max_examples=60, deadline=None)
@given(corners=st.integers(4, 24), seed=st.integers(0, 10**6))
def test_concave_polygons_are_cut_inside_themselves(corners, seed):
    rng = np.random.default_rng(seed)
    polygon = star(corners, rng)
    angle = np.sort(np.arctan2(polygon[:, 1], polygon[:, 0]))
    if np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() > np.pi - 0.1:
        return  # the origin lies outside: angles do not order a simple polygon
    spun = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    mesh = PolygonMesh(polygon @ spun.T, [np.arange(corners)])
    assert mesh.triangles.shape == (corners - 2, 3)
    assert area(mesh.points, mesh.triangles) == pytest.approx(
        abs(shoelace(polygon)), rel=1e-9
    )  # no overlap, no overhang
    normal = np.cross(*(mesh.points[mesh.triangles[:, i]] - mesh.points[mesh.triangles[:, 0]] for i in (1, 2)))
    assert (normal @ spun[:, 2] * np.sign(np.linalg.det(spun)) * np.sign(shoelace(polygon)) > -1e-12).all()


def test_mixed_polygons_keep_order_and_corners():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0], [9, 9, 9.0]])
    mesh = PolygonMesh(points, [[0, 1, 2, 3], [1, 4, 2], [4, 5, 2], [0, 1]])
    assert [face.tolist() for face in mesh.faces] == [[0, 1, 2, 3], [1, 4, 2], [4, 5, 2], [0, 1]]
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2], [4, 5, 2]]
    assert mesh.triangle_faces.tolist() == [0, 0, 1, 2]
    assert np.array_equal(mesh.faces.flat[mesh.triangle_corners], mesh.triangles)
    assert len(mesh.points) == 7  # the unused vertex stays


def test_with_points_changes_nothing_else(box_mesh):
    moved = box_mesh.with_points(box_mesh.points + 1)
    for name in ("faces", "uvs", "normals", "groups", "carrier"):
        assert getattr(moved, name) is getattr(box_mesh, name)
    assert np.array_equal(moved.points, box_mesh.points + 1)


def test_a_mesh_is_frozen_and_keeps_its_own_points():
    mine = np.zeros((3, 3))
    mesh = PolygonMesh(mine, [[0, 1, 2]])
    mine[0] = 7
    assert not mesh.points.any()
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0] = 1
    with pytest.raises(AttributeError):
        mesh.points = mine
    with pytest.raises(TypeError):
        mesh.vertex_attributes["x"] = mine


def test_adjacency_of_a_box(box_mesh):
    cube = PolygonMesh(
        np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3),
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
    )
    assert len(cube.edges) == 12
    assert cube.edge_use == (0, 0)
    assert all(len(near) == 3 for near in cube.neighbors)
    assert np.allclose(cube.vertex_normals, (cube.points * 2 - 1) / np.sqrt(3))
    flipped = cube.replace(faces=[[0, 1, 3, 2][::-1], *cube.faces[1:]])
    assert flipped.edge_use == (0, 4)
    assert cube.replace(faces=cube.faces[1:]).edge_use == (4, 0)
    assert box_mesh.edge_use[1] == 0


def test_bounds_and_html():
    mesh = PolygonMesh([[0, 0, 0], [3, 4, 12.0]])
    assert mesh.diagonal == 13
    assert np.array_equal(mesh.center, [1.5, 2, 6])
    assert "<th>points</th><td>2</td>" in mesh._repr_html_()
    with pytest.raises(InvalidMesh, match="without points has no bounds"):
        _ = PolygonMesh(np.empty((0, 3))).bounds


def test_pickling(box_mesh):
    copy = pickle.loads(pickle.dumps(box_mesh))
    assert np.array_equal(copy.points, box_mesh.points)
    assert np.array_equal(copy.uvs.indices, box_mesh.uvs.indices)
    assert not copy.points.flags.writeable


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": np.zeros((2, 2))}, r"shape \(2, 2\)"),
        ({"points": [[0, 0, np.nan]]}, "1 of 1 points are not finite, the first is point 0"),
        ({"points": np.zeros((3, 3)), "faces": [[0, 1, 3]]}, "face 0 uses vertex 3; there are 3 vertices"),
        ({"points": np.zeros((3, 3)), "faces": [[0, 1, 2], [0, -1, 2]]}, "face 1 uses vertex -1"),
        ({"points": np.zeros((3, 3)), "lines": [[0, 9]]}, "line 0 uses vertex 9"),
        ({"points": np.zeros((3, 3)), "vertex_attributes": {"heat": np.zeros(2)}}, "'heat' has 2 rows; there are 3"),
        ({"points": np.zeros((3, 3)), "faces": [[0, 1, 2]], "groups": FaceLabels((), [])}, "groups has 0 rows"),
    ],
)
def test_contradictions_are_named(arguments, message):
    with pytest.raises(InvalidMesh, match=message):
        PolygonMesh(**arguments)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"points": "abc"}, "points is 'abc'; numbers are needed"),
        ({"points": [[0, 0, 0], [1, 1]]}, "in rows of one length"),
        ({"points": [[0, 0, 0]], "faces": [["a", 0, 0]]}, "rows of vertex indices are needed"),
        ({"points": [[0, 0, 0]], "faces": 5}, "the faces are 5"),
        ({"points": [[0, 0, 0]], "faces": [[0, 0, 2**40]]}, "rows of vertex indices are needed"),
        ({"points": [[0, 0, 0]], "lines": ["ab"]}, "the lines are"),
    ],
)
def test_what_is_no_number_is_refused_by_name(arguments, words):
    with pytest.raises(InvalidMesh, match=words):
        PolygonMesh(**arguments)


def test_corner_values_and_labels():
    values = CornerValues([[1.0, 2.0]], [0, -1])
    assert np.array_equal(values.per_corner, [[1, 2], [np.nan, np.nan]], equal_nan=True)
    with pytest.raises(InvalidMesh, match="corners use value 1; there are 1"):
        CornerValues([[1.0, 2.0]], [0, 1])
    with pytest.raises(InvalidMesh, match="corners use value -2; there are 1"):
        CornerValues([[1.0, 2.0]], [0, -2])
    labels = FaceLabels(("a", "b"), [1, 0, 1])
    assert labels.faces("b").tolist() == [0, 2]
    with pytest.raises(InvalidParameter, match="there are: a, b"):
        labels.faces("c")


def test_as_points_copies_only_what_could_change():
    mine = np.random.default_rng(0).random((5, 3))
    kept = as_points(mine)
    assert kept is not mine
    assert not kept.flags.writeable
    assert as_points(kept) is kept
    assert as_points(mine, borrow=True) is mine
    huge = np.full((2, 3), 1e308)  # their sum overflows, they do not
    assert np.array_equal(as_points(huge), huge)
