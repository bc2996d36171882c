"""PLY: any properties, as text and binary, and the very same file with other positions."""

import struct

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes

ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


def file(form, polygons, order="xyz"):
    """Four vertices with normals, colours and a quality; faces with texture coordinates and a flag."""
    head = f"ply\nformat {form} 1.0\ncomment made here\nobj_info 1\nelement material 1\nproperty double shine\n"
    head += "element vertex 4\n" + "".join(f"property float {axis}\n" for axis in order)
    head += "property double nx\nproperty double ny\nproperty double nz\n"
    head += "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty short quality\n"
    head += f"element face {len(polygons)}\nproperty uchar flag\nproperty list uchar int vertex_indices\n"
    head += "property list int float texcoord\nend_header\n"
    points = {"x": (0, 1, 1, 0), "y": (0, 0, 1, 1), "z": (0.5, 0.25, 0, 0)}
    rows = [("d", 0.75)]
    for i in range(4):
        rows += [("f", points[axis][i]) for axis in order] + [("d", 0), ("d", 0), ("d", 1)]
        rows += [("B", 10 * i), ("B", 2), ("B", 3), ("h", -i)]
    for i, polygon in enumerate(polygons):
        rows += [("B", i), ("B", len(polygon)), *[("i", v) for v in polygon]]
        rows += [("i", 2 * len(polygon)), *[("f", 0.25 * k) for k in range(2 * len(polygon))]]
    prefix = ORDERS[form]
    if prefix:
        return head.encode() + b"".join(struct.pack(prefix + kind, value) for kind, value in rows)
    return head.encode() + b" \n".join(str(value).encode() for _, value in rows) + b"\n"


@pytest.mark.parametrize("polygons", [[(0, 1, 2, 3)], [(0, 1, 2), (0, 2, 3)], [(0, 1, 2), (0, 1, 2, 3), (3, 1)]])
@pytest.mark.parametrize("order", ["xyz", "zxy"])
@pytest.mark.parametrize("form", ORDERS)
def test_every_encoding_holds_the_same_mesh(form, order, polygons, tmp_path):
    data = file(form, polygons, order)
    mesh = read_mesh_bytes(data, "a.ply")
    assert mesh.points.tolist() == [[0, 0, 0.5], [1, 0, 0.25], [1, 1, 0], [0, 1, 0]]
    assert [tuple(row) for row in mesh.faces] == polygons
    assert mesh.vertex_attributes["colors"].tolist() == [[0, 2, 3], [10, 2, 3], [20, 2, 3], [30, 2, 3]]
    assert mesh.vertex_attributes["quality"].dtype == np.int16
    assert mesh.vertex_attributes["normals"].tolist() == [[0, 0, 1]] * 4
    assert mesh.face_attributes["flag"].tolist() == list(range(len(polygons)))
    expected = np.concatenate([0.25 * np.arange(2 * len(polygon)) for polygon in polygons]).reshape(-1, 2)
    assert np.array_equal(mesh.uvs.per_corner, expected)
    pl.write(mesh, tmp_path / "same.ply", strict=True)
    assert (tmp_path / "same.ply").read_bytes() == data

    moved = mesh.with_points(mesh.points * 0.5, normals=np.tile([1.0, 0, 0], (4, 1)))
    pl.write(moved, tmp_path / "moved.ply", strict=True)
    again = pl.read(tmp_path / "moved.ply")
    assert np.array_equal(again.points, moved.points)
    assert again.vertex_attributes["normals"].tolist() == [[1, 0, 0]] * 4
    back = again.with_points(mesh.points, normals=mesh.vertex_attributes["normals"])
    pl.write(back, tmp_path / "back.ply")
    if form != "ascii":
        assert (tmp_path / "back.ply").read_bytes() == data


def test_single_precision_stays_and_is_noted(tmp_path):
    mesh = read_mesh_bytes(file("binary_little_endian", [(0, 1, 2)]), "a.ply")
    report = pl.write(mesh.with_points(mesh.points + 0.1), tmp_path / "b.ply")
    assert not report.losses
    assert "rounded" in report.notes[0]
    assert np.array_equal(pl.read(tmp_path / "b.ply").points, (mesh.points + 0.1).astype(np.float32))
    with pytest.raises(UnsupportedFormat, match="do not fit"):
        pl.write(mesh.with_points(mesh.points * 1e39), tmp_path / "c.ply")


def test_strips_are_triangles_of_alternating_order():
    head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    body = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 4 4\n"
    mesh = read_mesh_bytes((head + body).encode(), "a.ply")
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2], [2, 1, 3], [2, 3, 4]]


def test_texture_coordinates_of_vertices_and_edges_survive(tmp_path):
    head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
    head += "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_index\n"
    head += "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    mesh = read_mesh_bytes((head + "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 2 1\n0 1\n2 1\n").encode(), "a.ply")
    assert mesh.uvs.per_corner.tolist() == [[0, 0], [0, 1], [1, 0]]
    assert [row.tolist() for row in mesh.lines] == [[0, 1], [2, 1]]
    report = pl.write(mesh.replace(carrier=None), tmp_path / "b.ply", strict=True)
    again = pl.read(tmp_path / "b.ply")
    assert not report.losses
    assert np.array_equal(again.uvs.per_corner, mesh.uvs.per_corner)
    assert np.array_equal(again.lines.flat, mesh.lines.flat)


def test_attributes_of_any_shape_survive_a_new_file(tmp_path):
    random = np.random.default_rng(5)
    mesh = pl.PolygonMesh(
        random.normal(size=(5, 3)),
        [[0, 1, 2], [0, 1, 2, 3, 4]],
        vertex_attributes={"stress": random.normal(size=(5, 6)), "id": np.arange(5), "heat": random.normal(size=5)},
        face_attributes={"colors": np.array([[1, 2, 3, 4], [5, 6, 7, 8]], np.uint8), "big": np.array([1, 2**40])},
    )
    pl.write(mesh, tmp_path / "a.ply", strict=True)
    again = pl.read(tmp_path / "a.ply")
    for old, new in ((mesh.vertex_attributes, again.vertex_attributes), (mesh.face_attributes, again.face_attributes)):
        assert set(old) == set(new)
        assert all(np.array_equal(old[name], new[name]) for name in old)


GOOD = file("ascii", [(0, 1, 2)])
LITTLE = file("binary_little_endian", [(0, 1, 2)])
QUARTER = struct.pack("<f", 0.25)


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (GOOD.replace(b"format ascii 1.0", b"format morse 1.0"), "line 2: .*'format morse 1.0' is not PLY"),
        (GOOD.replace(b"property short quality", b"property brief quality"), "line 17"),
        (GOOD.replace(b"element vertex 4", b"element vertex -4"), "'element vertex -4'"),
        (GOOD.replace(b"element vertex 4", b"element vertex 1000000000"), "1,000,000,000 of 'vertex' are announced"),
        (GOOD[: GOOD.index(b"end_header")], "header does not end"),
        (GOOD[:-20], "are announced; the file ends"),
        (LITTLE[:-1], "are announced; the file ends"),
        (GOOD.replace(b"\n2 \n6 ", b"\n4 \n6 "), "face 0 uses vertex 4; the file has 4"),
        (LITTLE.replace(struct.pack("<Biii", 3, 0, 1, 2), struct.pack("<Biii", 3, 0, -1, 2)), "uses vertex -1"),
        (LITTLE.replace(QUARTER, struct.pack("<f", np.nan), 1), f"byte {LITTLE.index(QUARTER)}: vertex 1 lies at"),
        (GOOD.replace(b"property float x", b"property float q"), "no vertices with x, y and z"),
    ],
)
def test_what_is_wrong_is_named(data, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(data, "bad.ply")
