"""Clouds of points: tables, and the other formats without faces."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import UnreadableFile
from pliant.io.meshes import read_mesh_bytes

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.25]])


def test_named_columns_are_what_they_say(tmp_path):
    text = b"\xef\xbb\xbfid;X;Y;Z;r;g;b;nx;ny;nz;heat\n7;0;0;0;255;0;9;0;0;1;1e-3\n8; 1.50;0;2;0;1;2;0;1;0;4\n"
    mesh = read_mesh_bytes(text, "stream")
    assert mesh.points.tolist() == [[0, 0, 0], [1.5, 0, 2]]
    assert mesh.vertex_attributes["colors"].tolist() == [[255, 0, 9], [0, 1, 2]]
    assert mesh.vertex_attributes["colors"].dtype == np.uint8
    assert mesh.vertex_attributes["normals"].tolist() == [[0, 0, 1], [0, 1, 0]]
    assert mesh.vertex_attributes["id"].tolist() == [7, 8]
    assert mesh.vertex_attributes["heat"].tolist() == [0.001, 4]
    assert not len(mesh.faces)
    pl.write(mesh, tmp_path / "same.csv", strict=True)
    assert (tmp_path / "same.csv").read_bytes() == text
    pl.write(mesh.with_points(mesh.points * 2), tmp_path / "moved.csv", strict=True)
    assert (tmp_path / "moved.csv").read_bytes() == text.replace(b"1.50;0;2;", b"3.0;0;4.0;")


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        ("", set()),
        (" 0.6 0.8 0", {"normals"}),
        (" 255 0 0", {"colors"}),
        (" 255 0 0 0.6 0.8 0", {"normals", "colors"}),
        (" 17.5", {"column 4"}),
        (" 0.6 0.8 0 3 4", {"normals", "column 7", "column 8"}),
    ],
)
def test_columns_without_names_are_what_they_hold(row, expected):
    text = "# a cloud\n" + "".join(f"{x} {y} {z}{row}\n" for x, y, z in POINTS)
    mesh = read_mesh_bytes(text.encode(), "cloud.xyz")
    assert np.array_equal(mesh.points, POINTS)
    assert set(mesh.vertex_attributes) == expected


@pytest.mark.parametrize("head", [b"# x y z\n", b"//X Y Z\n", b"x y z\r\n", b'"x", "y", "z"\n'])
def test_the_first_line_may_be_written_in_many_ways(head):
    assert read_mesh_bytes(head + b"1 2 3\n", "stream").points.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (b"0 0 0\n1 1\n", "line 2: a row has 2 numbers; 3 are expected"),
        (b"x,y,z\n0,0,0\n1,,1\n", "line 3: a row has 2 numbers; 3 are expected"),
        (b"0 0\n", "line 1: a row has 2 numbers; 3 are expected"),
        (b"x,y,z\n0,0,zero\n", "line 2: b'zero' stands where a number should"),
        (b"0 0 nan\n", "line 1: .*not a finite number"),
        (b"# nothing\n", "there is no point"),
        (b"3\nwater\nO 0 0 0\nH 0 0 1\nH 0 1 0\n", "line 2: b'water' stands"),
    ],
)
def test_what_is_wrong_is_named(data, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(data, "bad.xyz")


quick = settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
number = st.floats(-1e9, 1e9)


@quick
@given(st.lists(st.tuples(number, number, number, number), min_size=1, max_size=6), st.sampled_from([".csv", ".xyz"]))
def test_a_table_holds_points_and_their_numbers(tmp_path, rows, ending):
    table = np.array(rows)
    bits = np.arange(3 * len(rows), dtype=np.uint8).reshape(-1, 3)
    mesh = pl.PolygonMesh(table[:, :3], vertex_attributes={"heat": table[:, 3], "colors": bits + 2})
    pl.write(mesh, tmp_path / f"a{ending}", strict=True)
    again = pl.read(tmp_path / f"a{ending}")
    assert np.array_equal(again.points, mesh.points)
    assert np.array_equal(again.vertex_attributes["heat"], mesh.vertex_attributes["heat"])
    assert np.array_equal(again.vertex_attributes["colors"], mesh.vertex_attributes["colors"])


@pytest.mark.parametrize("ending", ["ply", "off", "obj", "csv", "xyz"])
def test_meshes_without_faces_are_points(ending, tmp_path):
    mesh = pl.PolygonMesh(POINTS)
    pl.write(mesh, tmp_path / f"a.{ending}", strict=True)
    again = pl.read(tmp_path / f"a.{ending}")
    assert np.array_equal(again.points, POINTS)
    assert len(again.faces) == 0
    pl.write(again.with_points(POINTS + 1), tmp_path / f"b.{ending}", strict=True)
    assert np.array_equal(pl.read(tmp_path / f"b.{ending}").points, POINTS + 1)


def test_faces_are_lost_in_a_table_and_told_of(box_mesh, tmp_path):
    losses = pl.write(box_mesh, tmp_path / "a.xyz").losses
    assert f"{len(box_mesh.faces):,} faces: points alone are kept" in losses
    assert np.array_equal(pl.read(tmp_path / "a.xyz").points, box_mesh.points)
