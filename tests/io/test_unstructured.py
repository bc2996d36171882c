"""VTK unstructured grids and grids, read in a process of its own."""

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes

pv = pytest.importorskip("pyvista")


@pytest.fixture
def mixed():
    """A tetrahedron, a hexahedron, a line, a triangle, a quadrilateral and a pixel over random points."""
    points = np.random.default_rng(3).normal(size=(12, 3))
    rows = [[0, 1], [0, 1, 2], [0, 1, 2, 3], range(8), [3, 4, 5, 6], [8, 9, 10, 11]]
    types = [pv.CellType.LINE, pv.CellType.TRIANGLE, pv.CellType.TETRA, pv.CellType.HEXAHEDRON, pv.CellType.QUAD]
    cells = np.concatenate([[len(row), *row] for row in rows])
    grid = pv.UnstructuredGrid(cells, [*types, pv.CellType.PIXEL], points)
    grid["heat"] = np.arange(12.0)
    grid.cell_data["id"] = np.arange(6)
    return grid


@pytest.mark.parametrize("ending", ["vtu", "vtk"])
def test_points_change_and_all_else_stays(mixed, ending, tmp_path):
    path = tmp_path / f"a.{ending}"
    mixed.save(path)
    mesh = pl.read(path)
    assert np.array_equal(mesh.points, mixed.points)
    assert [row.tolist() for row in mesh.faces] == [[0, 1, 2], [3, 4, 5, 6], [8, 9, 11, 10]]
    assert mesh.face_attributes["id"].tolist() == [1, 4, 5]
    assert [row.tolist() for row in mesh.lines] == [[0, 1]]
    assert {kind: rows.tolist() for kind, rows in mesh.cells.items()} == {
        "tetra": [[0, 1, 2, 3]],
        "hexahedron": [list(range(8))],
    }
    pl.write(mesh, tmp_path / f"same.{ending}", strict=True)
    assert (tmp_path / f"same.{ending}").read_bytes() == path.read_bytes()
    pl.write(mesh.with_points(mesh.points * 2), tmp_path / f"moved.{ending}", strict=True)
    moved = pv.read(tmp_path / f"moved.{ending}")
    assert np.array_equal(moved.points, mixed.points * 2)
    assert np.array_equal(moved.cells, mixed.cells)
    assert np.array_equal(moved.celltypes, mixed.celltypes)
    assert np.array_equal(moved["heat"], mixed["heat"])
    assert np.array_equal(moved.cell_data["id"], mixed.cell_data["id"])


def test_a_volume_from_elsewhere_arrives_whole(tmp_path):
    points = np.random.default_rng(4).normal(size=(9, 3))
    cells = {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]], "pyramid": [[0, 1, 2, 3, 8]]}
    mesh = pl.PolygonMesh(
        points,
        [[0, 1, 2], [3, 4, 5, 6], [0, 1, 2, 3, 4]],
        cells=cells,
        lines=[[0, 8], [1, 2, 3]],
        vertex_attributes={"heat": np.arange(9)},
        face_attributes={"id": np.array([5, 6, 7])},
    )
    pl.write(mesh, tmp_path / "a.vtu", strict=True)
    again = pl.read(tmp_path / "a.vtu")
    assert np.array_equal(again.points, points)
    for name in ("faces", "lines"):
        assert [row.tolist() for row in getattr(again, name)] == [row.tolist() for row in getattr(mesh, name)]
    assert {kind: rows.tolist() for kind, rows in again.cells.items()} == cells
    assert again.face_attributes["id"].tolist() == [5, 6, 7]
    assert np.array_equal(again.vertex_attributes["heat"], np.arange(9))
    losses = pl.write(again, tmp_path / "a.ply").losses
    assert "2 cells of the kind 'tetra'" in losses
    assert "the data of cells that are no faces" in losses


@pytest.mark.parametrize("ending", ["vti", "vtr", "vts", "vtk"])
def test_grids_are_the_points_that_they_imply(ending, tmp_path):
    grid = pv.ImageData(dimensions=(3, 4, 2), spacing=(0.5, 1, 2), origin=(1, 2, 3))
    if ending == "vtr":
        grid = grid.cast_to_rectilinear_grid()
    if ending == "vts":
        grid = grid.cast_to_structured_grid()
    grid["heat"] = np.arange(24.0)
    grid.save(tmp_path / f"a.{ending}")
    mesh = pl.read(tmp_path / f"a.{ending}")
    assert np.allclose(mesh.points, grid.points, rtol=0, atol=1e-12)
    assert np.array_equal(mesh.vertex_attributes["heat"], np.arange(24.0))
    assert not len(mesh.faces)
    if ending != "vtk":
        with pytest.raises(UnsupportedFormat, match=r"points that moved; write \.vtu"):
            pl.write(mesh, tmp_path / f"b.{ending}")


def test_damage_is_an_error_and_harms_nobody(mixed, tmp_path):
    for ending in ("vtu", "vtk"):
        mixed.save(tmp_path / f"a.{ending}")
    image = pv.ImageData(dimensions=(9, 9, 9))
    image["heat"] = np.arange(729.0)
    image.save(tmp_path / "a.vti")
    xml, legacy, grid = ((tmp_path / f"a.{ending}").read_bytes() for ending in ("vtu", "vtk", "vti"))
    for data in (
        xml[: len(xml) // 2],
        legacy[: len(legacy) // 2],
        grid[: len(grid) // 2],
        xml.replace(b'NumberOfPoints="12"', b'NumberOfPoints="1000000000"'),
        xml.replace(b'NumberOfCells="6"', b'NumberOfCells="1000000000"'),
        legacy.replace(b"POINTS 12", b"POINTS 1000000000"),
        grid.replace(b"0 8 0 8 0 8", b"0 999999999 0 8 0 8"),
    ):
        assert data not in (xml, legacy, grid)
        with pytest.raises(UnreadableFile, match=r"VTK|offsets|point"):
            read_mesh_bytes(data, "bad.vtu")


def test_polyhedra_are_refused_by_name(tmp_path):
    faces = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]
    stream = [4, *(number for face in faces for number in (3, *face))]
    grid = pv.UnstructuredGrid([len(stream), *stream], [pv.CellType.POLYHEDRON], np.eye(4, 3))
    grid.save(tmp_path / "a.vtu")
    with pytest.raises(UnsupportedFormat, match="polyhedra"):
        pl.read(tmp_path / "a.vtu")
