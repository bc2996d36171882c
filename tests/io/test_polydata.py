"""VTK polydata, read in a process of its own."""

import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.mesh_formats import polydata_process, vtp_file
from pliant.io.mesh_formats.format import Source
from pliant.io.meshes import read_mesh_bytes


@pytest.fixture
def sphere():
    mesh = pv.Sphere(theta_resolution=8, phi_resolution=8)
    mesh["heat"] = np.arange(mesh.n_points, dtype=np.float32)
    mesh.cell_data["id"] = np.arange(mesh.n_cells)
    return mesh


@pytest.mark.parametrize("ending", ["vtp", "vtk"])
def test_points_change_and_all_else_stays(sphere, ending, tmp_path):
    path = tmp_path / f"a.{ending}"
    sphere.save(path)
    mesh = pl.read(path)
    assert np.array_equal(mesh.points, sphere.points)
    assert np.array_equal(mesh.triangles, sphere.regular_faces)
    assert np.array_equal(mesh.vertex_attributes["heat"], sphere["heat"])
    pl.write(mesh, tmp_path / f"same.{ending}", strict=True)
    assert (tmp_path / f"same.{ending}").read_bytes() == path.read_bytes()
    report = pl.write(mesh.with_points(mesh.points + 1 / 3), tmp_path / f"moved.{ending}", strict=True)
    assert "rounded to 32 bits" in report.notes[0]
    moved = pv.read(tmp_path / f"moved.{ending}")
    assert moved.points.dtype == np.float32
    assert np.array_equal(moved.points, (mesh.points + 1 / 3).astype(np.float32))
    assert np.array_equal(moved.faces, sphere.faces)
    for name in sphere.point_data:
        assert np.array_equal(moved.point_data[name], sphere.point_data[name])
    assert np.array_equal(moved.cell_data["id"], sphere.cell_data["id"])


@pytest.mark.parametrize("mode", [1, 2])
@pytest.mark.parametrize("encoded", [0, 1])
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize(("header", "order"), [(32, 1), (64, 0)])
def test_every_binary_layout_reads_as_vtk_reads_it(mode, encoded, compressed, header, order, tmp_path):
    random = np.random.default_rng(2)
    made = pv.PolyData(random.normal(size=(900, 3)), verts=[1, 7], lines=[3, 0, 1, 2], faces=[4, 0, 1, 2, 3] * 400)
    made["v"], made["u"] = random.normal(size=(900, 3)).astype(np.float32), np.arange(900).astype(np.uint8)
    made.cell_data["id"], made.field_data["f"] = np.arange(402), [1.5, 2]
    made.field_data["word"] = ["hello"]
    made.point_data.active_normals_name = "v"
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(tmp_path / "a.vtp"))
    writer.SetInputData(made)
    writer.SetDataMode(mode)
    writer.SetEncodeAppendedData(encoded)
    writer.SetBlockSize(4096)
    writer.SetHeaderType(header)
    writer.SetByteOrder(order)
    if not compressed:
        writer.SetCompressorTypeToNone()
    writer.Write()
    data = (tmp_path / "a.vtp").read_bytes()
    own = vtp_file.read(data)
    assert own is not None
    arrays, meta = polydata_process.read(Source(data, "a.vtp"))
    meta.pop("arrays")
    assert own[1] == meta
    assert {name: (a.dtype, a.tolist()) for name, a in own[0].items()} == {
        name: (a.dtype, a.tolist()) for name, a in arrays.items()
    }
    for cut in (len(data) // 3, len(data) // 2, len(data) - 40):
        assert vtp_file.read(data[:cut]) is None


def test_points_lines_polygons_and_strips_stay_what_they_are(tmp_path):
    points = np.random.default_rng(2).normal(size=(8, 3))
    made = pv.PolyData(points, verts=[1, 7], lines=[3, 0, 1, 2], faces=[4, 0, 1, 2, 3], strips=[4, 4, 5, 6, 7])
    made.cell_data["id"] = np.array([10, 20, 30, 40])
    made.save(tmp_path / "a.vtp")
    mesh = pl.read(tmp_path / "a.vtp")
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2, 3], [4, 5, 6], [6, 5, 7]]
    assert mesh.face_attributes["id"].tolist() == [30, 40, 40]
    assert [row.tolist() for row in mesh.lines] == [[0, 1, 2]]
    assert any("cells that are points" in loss for loss in pl.write(mesh, tmp_path / "a.ply").losses)
    pl.write(mesh.with_points(mesh.points * 2), tmp_path / "b.vtp")
    again = pv.read(tmp_path / "b.vtp")
    for part in ("verts", "lines", "faces", "strips"):
        assert np.array_equal(getattr(again, part), getattr(made, part))
    assert again.points.dtype == np.float64
    assert np.array_equal(again.points, points * 2)
    assert again.cell_data["id"].tolist() == [10, 20, 30, 40]


@pytest.mark.parametrize("ending", ["vtp", "vtk"])
def test_a_mesh_from_elsewhere_arrives_whole(box_mesh, ending, tmp_path):
    box = box_mesh.replace(
        normals=None,
        groups=None,
        vertex_attributes={
            "normals": np.tile([0.0, 0, 1], (len(box_mesh.points), 1)),
            "heat": np.arange(len(box_mesh.points)),
        },
        face_attributes={"id": np.arange(len(box_mesh.faces))},
    )
    pl.write(box, tmp_path / f"box.{ending}", strict=True)
    again = pl.read(tmp_path / f"box.{ending}")
    assert np.array_equal(again.points, box.points)
    assert np.array_equal(again.faces.flat, box.faces.flat)
    assert np.array_equal(again.uvs.per_corner, box.uvs.per_corner)
    assert np.array_equal(again.vertex_attributes["normals"], box.vertex_attributes["normals"])
    assert np.array_equal(again.face_attributes["id"], box.face_attributes["id"])


def test_damage_is_an_error_and_harms_nobody(sphere, tmp_path):
    for ending in ("vtp", "vtk"):
        sphere.save(tmp_path / f"a.{ending}")
    xml, legacy = (tmp_path / "a.vtp").read_bytes(), (tmp_path / "a.vtk").read_bytes()
    count = str(sphere.n_points).encode()
    for data in (
        xml[: len(xml) // 2],
        legacy[: len(legacy) // 2],
        xml.replace(b'NumberOfPoints="' + count, b'NumberOfPoints="1000000000'),
        legacy.replace(b"POINTS " + count, b"POINTS 1000000000"),
    ):
        with pytest.raises(UnreadableFile, match="VTK"):
            read_mesh_bytes(data, "bad.vtp")


def test_other_data_is_named_as_what_it_is():
    with pytest.raises(UnsupportedFormat, match="table"):
        read_mesh_bytes(b'<?xml version="1.0"?>\n<VTKFile type="Table" version="0.1">', "image.vtp")
