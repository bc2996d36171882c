"""OFF and its relatives with colours, normals and texture coordinates."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes

PLAIN = b"""OFF
# made by hand
4 2 0

0 0 0
1.000 0 0  # a corner
1 1 0
0 1 0
4 0 1 2 3
3 0 1 2 255 0 128
"""

FULL = b"""STCNOFF 3 1 0
0 0 0 0 0 1 255 0 0 255 0 0
1 0 0 0 0 1 0 255 0 255 1 0
0 1 0 0 0 1 0 0 255 255 0 1
3 0 1 2 1 0 0.5
"""


def test_polygons_are_kept_and_the_file_comes_back(tmp_path):
    mesh = read_mesh_bytes(PLAIN, "a.off")
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2, 3], [0, 1, 2]]
    pl.write(mesh, tmp_path / "b.off", strict=True)
    assert (tmp_path / "b.off").read_bytes() == PLAIN
    points = mesh.points.copy()
    points[1, 1] = 1e-9
    pl.write(mesh.with_points(points), tmp_path / "c.off", strict=True)
    assert (tmp_path / "c.off").read_bytes() == PLAIN.replace(b"1.000 0 0  #", b"1.000 1e-9 0  #")


def test_all_that_vertices_and_faces_can_say():
    mesh = read_mesh_bytes(FULL, "a.off")
    assert mesh.vertex_attributes["normals"].tolist() == [[0, 0, 1]] * 3
    assert mesh.vertex_attributes["colors"].dtype == np.uint8
    assert mesh.vertex_attributes["colors"][1].tolist() == [0, 255, 0, 255]
    assert mesh.uvs.per_corner.tolist() == [[0, 0], [1, 0], [0, 1]]
    assert mesh.face_attributes["colors"].tolist() == [[1, 0, 0.5]]


def test_a_new_file_keeps_normals_colors_and_coordinates(tmp_path):
    mesh = read_mesh_bytes(FULL.replace(b"255", b"0.3"), "a.off")
    pl.write(mesh.replace(carrier=None), tmp_path / "b.off", strict=True)
    again = pl.read(tmp_path / "b.off")
    assert np.array_equal(again.uvs.per_corner, mesh.uvs.per_corner)
    for name in ("normals", "colors"):
        assert np.array_equal(again.vertex_attributes[name], mesh.vertex_attributes[name])
    assert np.array_equal(again.face_attributes["colors"], mesh.face_attributes["colors"])


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (PLAIN.replace(b"4 2 0", b"4 3 0"), "7 lines of vertices and faces are announced; 6 follow"),
        (PLAIN.replace(b"4 2 0", b"4 x 0"), "line 3: .*'x'"),
        (PLAIN.replace(b"4 2 0", b"400000000 2 0"), "line 3: .*the file has"),
        (PLAIN.replace(b"3 0 1 2", b"3 0 1 4"), "line 10: face 1 uses vertex 4; the file has 4"),
        (PLAIN.replace(b"3 0 1 2 255 0 128", b"9 0 1 2"), "line 10: face 1 announces 9 corners; 3 numbers"),
        (PLAIN.replace(b"1 1 0", b"1 1"), "line 7: a vertex has 2 numbers"),
        (PLAIN.replace(b"1 1 0", b"1 1 inf"), "line 7: .*not a finite"),
        (b"OFF\n", "counts of vertices and faces are missing"),
    ],
)
def test_what_is_wrong_is_named(data, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(data, "bad.off")


@pytest.mark.parametrize("head", [b"OFF BINARY\n", b"4OFF\n", b"nOFF\n3\n"])
def test_forms_that_are_not_read_are_named(head):
    with pytest.raises(UnsupportedFormat, match="save it as plain OFF"):
        read_mesh_bytes(head + b"1 0 0\n0 0 0\n", "odd.off")
