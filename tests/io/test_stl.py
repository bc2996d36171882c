"""STL: loose triangles kept as they are."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes

RECORD = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
TEXT = b"""solid left wing
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1.00 0 0
      vertex 0 1 0
    endloop
  endfacet
endsolid left wing
solid right
  FACET NORMAL 0 0 9
    OUTER LOOP
      VERTEX 1 0 0
      VERTEX 1 1 0
      VERTEX 0 1 0
    ENDLOOP
  ENDFACET
endsolid right
"""


def binary(head, count=4):
    records = np.zeros(count, RECORD)
    records["points"] = np.random.default_rng(3).normal(size=(count, 3, 3))
    records["normal"] = 7  # not what the points say
    records["attribute"] = np.arange(count)
    return head.ljust(80, b"\0") + count.to_bytes(4, "little") + records.tobytes()


@pytest.mark.parametrize("head", [b"anything", b"solid as a rock"])
def test_binary_files_come_back_byte_for_byte(head, tmp_path):
    data = binary(head)
    mesh = read_mesh_bytes(data, "a.stl")
    assert len(mesh.points) == 12
    assert mesh.face_attributes["attribute"].tolist() == [0, 1, 2, 3]
    pl.write(mesh, tmp_path / "b.stl", strict=True)
    assert (tmp_path / "b.stl").read_bytes() == data


def test_only_moved_triangles_get_new_numbers(tmp_path):
    data = binary(b"head")
    mesh = read_mesh_bytes(data, "a.stl")
    points = mesh.points.copy()
    points[3] += 0.5
    pl.write(mesh.with_points(points), tmp_path / "b.stl")
    old, new = (np.frombuffer(each, RECORD, offset=84) for each in (data, (tmp_path / "b.stl").read_bytes()))
    assert (old[[0, 2, 3]] == new[[0, 2, 3]]).all()
    a, b, c = points[3:6]
    normal = np.cross(b - a, c - a)
    assert np.allclose(new["normal"][1], normal / np.linalg.norm(normal), atol=1e-6)
    assert (new["attribute"] == old["attribute"]).all()


def test_text_keeps_solids_and_all_else(tmp_path):
    mesh = read_mesh_bytes(TEXT, "a.stl")
    assert mesh.objects.names == ("left wing", "right")
    assert mesh.objects.indices.tolist() == [0, 1]
    pl.write(mesh, tmp_path / "b.stl", strict=True)
    assert (tmp_path / "b.stl").read_bytes() == TEXT
    points = mesh.points.copy()
    points[0, 0] = -0.1
    pl.write(mesh.with_points(points), tmp_path / "c.stl")
    expected = TEXT.replace(b"vertex 0 0 0\n      vertex 1.00", b"vertex -0.1 0 0\n      vertex 1.00")
    assert (tmp_path / "c.stl").read_bytes().replace(b"0.0 0.0 1.0", b"0 0 1") == expected


def test_other_meshes_lose_sharing_and_precision_and_are_told(box_mesh, tmp_path):
    moved = box_mesh.with_points(box_mesh.points + 0.1)
    losses = " ".join(pl.write(moved, tmp_path / "box.stl").losses)
    for word in (
        "96 polygons are cut into 192 triangles",
        "no longer share",
        "rounded to 32 bits",
        "texture",
        "groups",
    ):
        assert word in losses
    again = pl.read(tmp_path / "box.stl")
    assert np.array_equal(again.points, moved.points[moved.triangles].reshape(-1, 3).astype(np.float32))


def test_numbers_beyond_single_precision_are_refused(tmp_path):
    mesh = pl.PolygonMesh([[0, 0, 0], [1e39, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(UnsupportedFormat, match="1e\\+39"):
        pl.write(mesh, tmp_path / "huge.stl")
    assert not (tmp_path / "huge.stl").exists()


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (binary(b"head")[:-1], "4 triangles need 284 bytes; the file has 283"),
        (binary(b"head") + b"x", "the file has 285"),
        (b"short", "at least 84"),
        (TEXT[:270], "ends within a solid|out of order"),
        (TEXT.replace(b"      vertex 0 1 0\n", b"", 1), "line 6: a statement is out of order"),
        (TEXT.replace(b"vertex 1.00 0 0", b"vertex 1.00 0"), "line 5: three numbers"),
        (TEXT.replace(b"vertex 1.00 0 0", b"vertex nan 0 0"), "line 5: .*not a finite"),
    ],
)
def test_what_is_wrong_is_named(data, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(data, "bad.stl")


def test_a_corner_that_is_not_finite_is_found():
    data = bytearray(binary(b"head"))
    data[84 + 50 + 12 : 84 + 50 + 16] = np.float32(np.nan).tobytes()
    with pytest.raises(UnreadableFile, match="byte 146: triangle 1"):
        read_mesh_bytes(bytes(data), "bad.stl")
