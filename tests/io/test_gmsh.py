"""gmsh files, read by meshio in a process of its own and written back byte for byte."""

import struct

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile
from pliant.io.meshes import read_mesh_bytes

meshio = pytest.importorskip("meshio")

TEXT_22 = b"""$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
2 7 "wall"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1.50 0 0
3 0 1 0
9 0 0 1e0
$EndNodes
$Elements
3
1 2 2 7 1 1 2 3
2 2 2 8 1 1 2 9
3 4 2 5 1 1 2 3 9
$EndElements
"""
TEXT_41 = b"""$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 1 1
1 0 0 0 1 1 1 0 0
1 0 0 0 1 1 1 0 1 1
$EndEntities
$Nodes
2 4 1 9
2 1 0 3
1
2
3
0 0 0
1.50 0 0
0 1 0
3 1 0 1
9
0 0 1e0
$EndNodes
$Elements
2 3 1 3
2 1 2 2
1 1 2 3
2 1 2 9
3 1 4 1
3 1 2 3 9
$EndElements
"""
POINTS = np.array([[0, 0, 0], [1.5, 0, 0], [0, 1, 0], [0, 0, 1]])


def binary_41():
    """The same mesh in the binary form of version 4.1."""
    blocks = [(2, 1, [1, 2, 3], POINTS[:3]), (3, 1, [9], POINTS[3:])]
    nodes = struct.pack("<4Q", 2, 4, 1, 9)
    for dimension, tag, numbers, points in blocks:
        nodes += struct.pack(f"<3iQ{len(numbers)}Q", dimension, tag, 0, len(numbers), *numbers) + points.tobytes()
    elements = struct.pack("<4Q", 2, 3, 1, 3) + struct.pack("<3iQ8Q", 2, 1, 2, 2, 1, 1, 2, 3, 2, 1, 2, 9)
    elements += struct.pack("<3iQ5Q", 3, 1, 4, 1, 3, 1, 2, 3, 9)
    entities = struct.pack("<4Q", 0, 0, 1, 1) + 2 * (
        struct.pack("<i6d", 1, 0, 0, 0, 1, 1, 1) + struct.pack("<2Q", 0, 0)
    )
    sections = {"Entities": entities, "Nodes": nodes, "Elements": elements}
    head = b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n"
    return head + b"".join(f"${k}\n".encode() + v + f"\n$End{k}\n".encode() for k, v in sections.items())


def binary_22(tmp_path):
    mesh = meshio.Mesh(POINTS, [("triangle", [[0, 1, 2], [0, 1, 3]]), ("tetra", [[0, 1, 2, 3]])])
    zeros = [np.zeros(2, np.int32), np.zeros(1, np.int32)]
    mesh.cell_data = {"gmsh:physical": zeros, "gmsh:geometrical": zeros}
    meshio.write(tmp_path / "a.msh", mesh, file_format="gmsh22", binary=True)
    return (tmp_path / "a.msh").read_bytes()


@pytest.mark.parametrize("form", ["text 2.2", "text 4.1", "binary 2.2", "binary 4.1"])
def test_points_change_and_all_else_stays(form, tmp_path):
    texts = {"text 2.2": TEXT_22, "text 4.1": TEXT_41, "binary 4.1": binary_41()}
    data = texts[form] if form in texts else binary_22(tmp_path)
    mesh = read_mesh_bytes(data, "stream")
    assert np.array_equal(mesh.points, POINTS)
    assert mesh.faces.flat.reshape(-1, 3).tolist() == [[0, 1, 2], [0, 1, 3]]
    assert mesh.cells["tetra"].tolist() == [[0, 1, 2, 3]]
    pl.write(mesh, tmp_path / "same.msh", strict=True)
    assert (tmp_path / "same.msh").read_bytes() == data
    pl.write(mesh.with_points(mesh.points * 3), tmp_path / "moved.msh", strict=True)
    moved = (tmp_path / "moved.msh").read_bytes()
    assert np.array_equal(pl.read(tmp_path / "moved.msh").points, POINTS * 3)
    if form.startswith("text"):
        expected = data.replace(b"1.50 0 0\n", b"4.5 0 0\n").replace(b"0 1 0\n9", b"0 3.0 0\n9")
        expected = expected.replace(b"0 1 0\n3 1 0 1", b"0 3.0 0\n3 1 0 1").replace(b"1e0", b"3.0")
        assert moved == expected
    else:
        assert len(moved) == len(data)
        assert sum(a != b for a, b in zip(moved, data, strict=True)) <= 3 * 8


def test_physical_surfaces_are_groups():
    mesh = read_mesh_bytes(TEXT_22, "a.msh")
    assert mesh.groups.names == ("wall",)
    assert mesh.groups.indices.tolist() == [0, -1]
    assert mesh.face_attributes["gmsh:physical"].tolist() == [7, 8]


def test_a_volume_from_elsewhere_arrives_whole(tmp_path):
    points = np.random.default_rng(5).normal(size=(6, 3))
    mesh = pl.PolygonMesh(
        points,
        [[0, 1, 2], [0, 1, 2, 3], [3, 4, 5]],
        cells={"tetra": [[0, 1, 2, 3]], "wedge": [[0, 1, 2, 3, 4, 5]]},
        lines=[[0, 5]],
        face_attributes={"gmsh:physical": np.array([4, 5, 6])},
    )
    pl.write(mesh, tmp_path / "a.msh", strict=True)
    again = pl.read(tmp_path / "a.msh")
    assert np.array_equal(again.points, points)
    assert [row.tolist() for row in again.faces] == [row.tolist() for row in mesh.faces]
    assert again.face_attributes["gmsh:physical"].tolist() == [4, 5, 6]
    assert {kind: rows.tolist() for kind, rows in again.cells.items()} == {
        kind: rows.tolist() for kind, rows in mesh.cells.items()
    }
    assert again.lines[0].tolist() == [0, 5]


@pytest.mark.parametrize(
    "data",
    [
        TEXT_22[:150],
        TEXT_22.replace(b"$Nodes\n4", b"$Nodes\n1000000000"),
        TEXT_22.replace(b"1 2 3 9\n$", b"1 2 3 8\n$"),
        binary_41()[:300],
        TEXT_41.replace(b"2 4 1 9", b"2 99999999999 1 9"),
    ],
)
def test_damage_is_an_error_and_harms_nobody(data):
    with pytest.raises(UnreadableFile, match=r"meshio|vertex|cell"):
        read_mesh_bytes(data, "bad.msh")
