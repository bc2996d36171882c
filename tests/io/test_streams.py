"""Meshes in compressed files and in streams."""

import gzip
import io

import numpy as np
import pytest

import pliant as pl
from pliant.errors import LossRefused, UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes

ENDINGS = ("obj", "ply", "stl", "off")


@pytest.mark.parametrize("ending", ENDINGS)
def test_compression_changes_nothing(box_mesh, ending, tmp_path):
    pl.write(box_mesh, tmp_path / f"box.{ending}")
    data = (tmp_path / f"box.{ending}").read_bytes()
    (tmp_path / f"packed.{ending}.gz").write_bytes(gzip.compress(data))
    mesh, packed = pl.read(tmp_path / f"box.{ending}"), pl.read(tmp_path / f"packed.{ending}.gz")
    assert np.array_equal(packed.points, mesh.points)
    assert np.array_equal(packed.faces.flat, mesh.faces.flat)
    report = pl.write(packed, tmp_path / f"again.{ending}.gz", strict=True)
    assert gzip.decompress(report.path.read_bytes()) == data
    pl.write(packed, tmp_path / f"again.{ending}", strict=True)
    assert (tmp_path / f"again.{ending}").read_bytes() == data


def test_compressed_data_are_inflated_within_reason():
    bomb = gzip.compress(b"OFF\n" + b" " * (1 << 28), 9)
    with pytest.raises(UnreadableFile, match="inflate to more than"):
        read_mesh_bytes(bomb, "bomb.off.gz")
    whole = gzip.compress(b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")
    with pytest.raises(UnreadableFile, match="cut off"):
        read_mesh_bytes(whole[:-12], "cut.off.gz")
    with pytest.raises(UnreadableFile, match="damaged"):
        read_mesh_bytes(whole[:12] + b"\xff\xff\xff" + whole[15:], "broken.off.gz")


@pytest.mark.parametrize("ending", ENDINGS)
def test_streams_are_read_and_written_like_files(box_mesh, ending, tmp_path):
    pl.write(box_mesh, tmp_path / f"box.{ending}")
    data = (tmp_path / f"box.{ending}").read_bytes()
    mesh = pl.read(io.BytesIO(data), name=f"box.{ending}")
    assert np.array_equal(mesh.points, pl.read(tmp_path / f"box.{ending}").points)
    out = io.BytesIO()
    report = pl.write(mesh, out, name=f"box.{ending}", strict=True)
    assert out.getvalue() == data
    assert report.path.name == f"box.{ending}"


def test_a_stream_knows_its_own_name(box_mesh, tmp_path):
    with (tmp_path / "box.off").open("wb") as out:
        pl.write(box_mesh, out)
    with (tmp_path / "box.off").open("rb") as stream:
        assert pl.read(stream).source == tmp_path / "box.off"


def test_what_a_stream_cannot_give_is_named(box_mesh):
    with pytest.raises(UnreadableFile, match=r"gives text.*'rb'"):
        pl.read(io.StringIO("OFF"))
    with pytest.raises(UnreadableFile, match="rewind"):
        pl.read(io.BytesIO())
    with pytest.raises(UnsupportedFormat, match="no mesh format"):
        pl.write(box_mesh, io.BytesIO())


def test_a_stream_has_no_place_for_a_material_library():
    mesh = pl.PolygonMesh(np.eye(3), [[0, 1, 2]])
    red = pl.mesh.Material("red", (1, 0, 0))
    painted = mesh.replace(material_library={"red": red}, materials=pl.mesh.FaceLabels(("red",), [0]))
    with pytest.raises(LossRefused, match=r"a\.mtl"):
        pl.write(painted, io.BytesIO(), name="a.obj", strict=True)
