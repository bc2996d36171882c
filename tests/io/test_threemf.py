"""3MF packages."""

import io
import zipfile

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes
from pliant.mesh import FaceLabels, Material

MODEL = b"""<?xml version="1.0" encoding="UTF-8"?>
<!-- <vertex x="9" y="9" z="9"/> -->
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
 <metadata name="Title">kept</metadata>
 <resources>
  <basematerials id="5"><base name="red" displaycolor="#FF0000"/>
   <base name="sky" displaycolor="#0080FFFF"/></basematerials>
  <object id="1" name="leaf" pid="5" pindex="0"><mesh>
   <vertices><vertex x="0" y="0" z="0"/><vertex y='0' x='1.50' z='0'/><vertex x="0" y="1" z="0"/></vertices>
   <triangles><triangle v1="0" v2="1" v3="2"/><triangle v1="2" v2="1" v3="0" pid="5" p1="1"/></triangles>
  </mesh></object>
  <object id="2"><components><component objectid="1" transform="2 0 0 0 2 0 0 0 2 0 0 0"/></components></object>
 </resources>
 <build>%b</build>
</model>
"""
ONE = b'<item objectid="2" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/>'
TWO = ONE + b'<item objectid="1"/>'


def package(model, name="3D/3dmodel.model"):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        made.writestr("Metadata/note.txt", "mine")
        made.writestr(name, model)
    return out.getvalue()


def test_what_is_built_is_read_where_it_stands():
    mesh = read_mesh_bytes(package(MODEL % TWO), "a.3mf")
    assert mesh.points.tolist() == [[10, 0, 0], [10, 3, 0], [8, 0, 0], [0, 0, 0], [1.5, 0, 0], [0, 1, 0]]
    assert mesh.faces.flat.reshape(-1, 3).tolist() == [[0, 1, 2], [2, 1, 0], [3, 4, 5], [5, 4, 3]]
    assert mesh.materials.names == ("red", "sky")
    assert mesh.materials.indices.tolist() == [0, 1, 0, 1]
    assert mesh.material_library["red"].color == (1, 0, 0)


def test_positions_change_and_all_else_stays(tmp_path):
    data = package(MODEL % ONE)
    mesh = read_mesh_bytes(data, "a.3mf")
    pl.write(mesh, tmp_path / "same.3mf", strict=True)
    assert (tmp_path / "same.3mf").read_bytes() == data
    points = mesh.points.copy()
    points[1, 2] = 4
    pl.write(mesh.with_points(points), tmp_path / "moved.3mf", strict=True)
    with zipfile.ZipFile(tmp_path / "moved.3mf") as moved:
        assert moved.read("Metadata/note.txt") == b"mine"
        text = moved.read("3D/3dmodel.model")
    assert text == (MODEL % ONE).replace(b"y='0' x='1.50' z='0'", b'y="0.0" x="1.5" z="2.0"')
    assert np.array_equal(pl.read(tmp_path / "moved.3mf").points, points)


def test_an_object_in_two_places_moves_alike_or_becomes_another_file(tmp_path):
    mesh = read_mesh_bytes(package(MODEL % TWO), "a.3mf")
    points = mesh.points.copy()
    points[0] += 1
    pl.write(mesh.with_points(points), tmp_path / "apart.3mf")
    again = pl.read(tmp_path / "apart.3mf")
    assert np.array_equal(again.points, points)
    assert len(again.objects.names) == 1


def test_a_new_package_holds_polygons_as_triangles_and_materials(tmp_path):
    mesh = pl.PolygonMesh(
        np.random.default_rng(6).normal(size=(5, 3)),
        [[0, 1, 2, 3], [2, 3, 4]],
        materials=FaceLabels(("a & b", "plain"), [0, -1]),
        material_library={"a & b": Material("a & b", (1, 0.2, 0))},
    )
    report = pl.write(mesh, tmp_path / "a.3mf")
    assert report.losses == ("1 polygons are cut into 2 triangles",)
    again = pl.read(tmp_path / "a.3mf")
    assert np.array_equal(again.points, mesh.points)
    assert np.array_equal(again.triangles, mesh.triangles)
    assert again.materials.indices.tolist() == [0, 0, -1]
    assert again.material_library["a & b"].color == (1, 0.2, 0)


def test_another_library_reads_what_is_written(box_mesh, tmp_path):
    lib3mf = pytest.importorskip("lib3mf")
    pl.write(box_mesh, tmp_path / "a.3mf")
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "a.3mf"))
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    found = objects.GetCurrentMeshObject()
    points = [list(vertex.Coordinates) for vertex in found.GetVertices()]
    assert np.array_equal(points, box_mesh.points.astype(np.float32))
    triangles = [list(triangle.Indices) for triangle in found.GetTriangleIndices()]
    assert np.array_equal(triangles, box_mesh.triangles)


BOMB = b'<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><model>&b;</model>'


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (package(MODEL % ONE)[:-60], "package is damaged"),
        (package(MODEL % b""), "builds nothing"),
        (package((MODEL % ONE)[:-40]), "the model, line"),
        (package((MODEL % ONE).replace(b'v3="2"', b'v3="3"')), "vertex 3; its object has 3"),
        (package((MODEL % ONE).replace(b' x="0" y="1"', b' x="zero" y="1"')), "line 9: ValueError"),
        (package((MODEL % ONE).replace(b' x="0" y="1"', b' x="nan" y="1"')), "not finite"),
        (package((MODEL % ONE).replace(b'component objectid="1"', b'component objectid="2"')), "without end"),
        (package((MODEL % ONE).replace(b'component objectid="1"', b'component objectid="7"')), "'7' is built and not"),
        (package(BOMB), "entities of its own"),
        (package(b" " * (1 << 28)), "inflates to 268,435,456 bytes"),
    ],
)
def test_what_is_wrong_is_named(data, cause):
    with pytest.raises(UnreadableFile, match=cause):
        read_mesh_bytes(data, "bad.3mf")


def test_parts_in_other_files_are_refused_by_name():
    elsewhere = (MODEL % ONE).replace(b"<component ", b'<component xmlns:p="x" p:path="/3D/other.model" ')
    with pytest.raises(UnsupportedFormat, match="in other files"):
        read_mesh_bytes(package(elsewhere), "bad.3mf")
