"""OFF and its relatives with colours, normals and texture coordinates."""

import struct

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


@pytest.mark.parametrize("head", [b"4OFF\n", b"nOFF\n3\n"])
def test_forms_that_are_not_read_are_named(head):
    with pytest.raises(UnsupportedFormat, match="save it as plain OFF"):
        read_mesh_bytes(head + b"1 0 0\n0 0 0\n", "odd.off")


PREFIXES = [st + c + n for st in ("", "ST") for c in ("", "C") for n in ("", "N")]


def binary(prefix):
    """A binary OFF of a triangle and a quadrilateral, and the columns of its vertices."""
    widths = [3, 3 * ("N" in prefix), 4 * ("C" in prefix), 2 * ("ST" in prefix)]
    table = np.random.default_rng(1).random((4, sum(widths))).astype(np.float32)
    faces = struct.pack(">5i3f", 3, 0, 1, 2, 3, 0.5, 0.25, 1) + struct.pack(">6i3f", 4, 0, 1, 2, 3, 3, 1, 0, 0)
    counts = struct.pack(">3i", 4, 2, 0)
    data = prefix.encode() + b"OFF BINARY\n" + counts + table.astype(">f4").tobytes() + faces
    return data, np.split(table, np.cumsum(widths)[:-1], axis=1)


@pytest.mark.parametrize("prefix", PREFIXES)
def test_binary_files_say_what_text_says(prefix, tmp_path):
    data, (points, normals, colors, uvs) = binary(prefix)
    mesh = read_mesh_bytes(data, "a.off")
    assert np.array_equal(mesh.points, points)
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2], [0, 1, 2, 3]]
    assert mesh.face_attributes["colors"].tolist() == [[0.5, 0.25, 1], [1, 0, 0]]
    if "N" in prefix:
        assert np.array_equal(mesh.vertex_attributes["normals"], normals)
    if "C" in prefix:
        assert np.array_equal(mesh.vertex_attributes["colors"], colors)
    if "ST" in prefix:
        assert np.array_equal(mesh.uvs.per_corner, uvs[mesh.faces.flat])
    pl.write(mesh, tmp_path / "same.off", strict=True)
    assert (tmp_path / "same.off").read_bytes() == data
    pl.write(mesh.with_points(mesh.points + 1), tmp_path / "moved.off", strict=True)
    moved = (tmp_path / "moved.off").read_bytes()
    table = np.frombuffer(moved[:-68], ">f4", offset=len(prefix) + 11 + 12).reshape(4, -1)
    assert np.array_equal(table[:, :3], (mesh.points + 1).astype(np.float32))
    assert np.array_equal(table[:, 3:], np.hstack([normals, colors, uvs]))
    assert moved[-68:] == data[-68:]


@pytest.mark.parametrize("prefix", PREFIXES)
def test_text_files_may_have_all_prefixes_together(prefix):
    _, columns = binary(prefix)
    rows = "\n".join(" ".join(repr(float(value)) for value in row) for row in np.hstack(columns))
    text = f"{prefix}OFF\n4 2 0\n{rows}\n3 0 1 2\n4 0 1 2 3\n".encode()
    lines, loose = read_mesh_bytes(text, "a.off"), read_mesh_bytes(text.replace(b"\n", b" "), "b.off")
    for mesh in (lines, loose):
        assert np.array_equal(mesh.points, columns[0])
        assert [row.tolist() for row in mesh.faces] == [[0, 1, 2], [0, 1, 2, 3]]
        assert ("normals" in mesh.vertex_attributes, "colors" in mesh.vertex_attributes) == (
            "N" in prefix,
            "C" in prefix,
        )
        assert ("ST" in prefix) == (mesh.uvs is not None)


def test_words_count_and_not_lines(tmp_path):
    text = b"OFF 5\n2 0 # counts\n0 0\n0 1 0 0 1 1 # half\n 0 0 1 0 .5 .5 1\n4 0 1\n2 3 255 0 0\n3 0 1 4 0 255 0\n"
    mesh = read_mesh_bytes(text, "a.off")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]]
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2, 3], [0, 1, 4]]
    assert mesh.face_attributes["colors"].tolist() == [[255, 0, 0], [0, 255, 0]]
    pl.write(mesh.with_points(mesh.points * 3), tmp_path / "b.off", strict=True)
    expected = text.replace(b"1 0 0 1 1 #", b"3.0 0 0 3.0 3.0 #").replace(
        b" 0 0 1 0 .5 .5 1", b" 0 0 3.0 0 1.5 1.5 3.0"
    )
    assert (tmp_path / "b.off").read_bytes() == expected


@pytest.mark.parametrize(
    ("damage", "cause"),
    [
        (lambda data: data[:16], "counts of vertices and faces are missing"),
        (lambda data: data[:-30], "2 of 'face' are announced"),
        (lambda data: data.replace(struct.pack(">3i", 4, 2, 0), struct.pack(">3i", 10**9, 2, 0)), "1,000,000,000 ver"),
        (lambda data: data.replace(struct.pack(">4i", 3, 0, 1, 2), struct.pack(">4i", 3, 0, 1, 9)), "vertex 9; .* 4 v"),
    ],
)
def test_damaged_binary_files_are_named(damage, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(damage(binary("")[0]), "bad.off")
