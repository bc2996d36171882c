"""What all mesh formats share: recognition, reports, strictness, and losses that agree with the table."""

import pickle
import shutil

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import LossRefused, UnreadableFile, UnsupportedFormat
from pliant.io.meshes import formats, read_mesh_bytes
from pliant.mesh import CornerValues, FaceLabels, PolygonMesh
from pliant.numerics.ragged import Ragged

ENDINGS = ("obj", "ply", "stl", "off")


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_a_file_holds_counts_for_more_than_its_ending(box_mesh, ending, tmp_path):
    pl.write(box_mesh, tmp_path / f"box.{ending}")
    expected = pl.read(tmp_path / f"box.{ending}")
    for other in (*ENDINGS, "dat"):
        shutil.copy(tmp_path / f"box.{ending}", tmp_path / f"copy.{other}")
        found = pl.read(tmp_path / f"copy.{other}")
        assert np.array_equal(found.points, expected.points)
        assert np.array_equal(found.faces.flat, expected.faces.flat)


def test_unknown_endings_and_contents_are_named(box_mesh, tmp_path):
    with pytest.raises(UnsupportedFormat, match=r"'\.abc'.*\.ply.*\.obj"):
        pl.write(box_mesh, tmp_path / "box.abc")
    (tmp_path / "what.dat").write_bytes(b"\x93NUMPY")
    with pytest.raises(UnsupportedFormat, match=r"what\.dat.*OBJ"):
        pl.read(tmp_path / "what.dat")
    (tmp_path / "empty.obj").touch()
    with pytest.raises(UnreadableFile, match="empty"):
        pl.read(tmp_path / "empty.obj")


def test_a_strict_write_refuses_and_leaves_what_was_there(box_mesh, tmp_path):
    path = tmp_path / "box.stl"
    path.write_bytes(b"precious")
    with pytest.raises(LossRefused, match="texture coordinates"):
        pl.write(box_mesh, path, strict=True)
    assert path.read_bytes() == b"precious"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("table", [each for each in formats() if each["written"]], ids=lambda table: table["name"])
def test_the_table_tells_the_losses(box_mesh, table, tmp_path):
    mesh = box_mesh.replace(
        lines=Ragged.of([[0, 1]]), cells={"tetra": [[0, 1, 2, 3]]}, vertex_attributes={"heat": np.arange(150.0)}
    )
    report = pl.write(mesh, tmp_path / f"box{table['suffixes'][0]}")
    again = pl.read(report.path)
    kept = {
        "polygons": np.array_equal(again.faces.lengths, mesh.faces.lengths),
        "groups": again.groups is not None,
        "lines": again.lines is not None,
        "vertex_attributes": "heat" in again.vertex_attributes,
        "corner_normals": again.normals is not None,
        "cells": "tetra" in again.cells,
    }
    assert kept == {name: table[name] for name in kept}
    words = {
        "polygons": "cut into" if table["faces"] else "points alone are kept",
        "groups": "groups",
        "lines": "lines",
        "vertex_attributes": "'heat'",
        "corner_normals": "normals at the corners",
        "cells": "1 cells of the kind 'tetra'",
    }
    for name, word in words.items():
        assert any(word in loss for loss in report.losses) == (not kept[name])


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_carrier_survives_pickling(box_mesh, ending, tmp_path):
    pl.write(box_mesh, tmp_path / f"a.{ending}")
    mesh = pickle.loads(pickle.dumps(pl.read(tmp_path / f"a.{ending}")))
    pl.write(mesh, tmp_path / f"b.{ending}", strict=True)
    assert (tmp_path / f"b.{ending}").read_bytes() == (tmp_path / f"a.{ending}").read_bytes()


names = st.text(st.characters(exclude_categories=["Cc", "Cs", "Z"]), min_size=1, max_size=8).filter(
    lambda name: not name.endswith("\\")  # it would continue the line
)
coordinates = st.floats(-1e6, 1e6).filter(lambda value: value == 0 or abs(value) > 1e-30)


@st.composite
def meshes(draw):
    """Mixed polygons, unused vertices, and some of: texture coordinates, normals, names, lines."""
    count = draw(st.integers(1, 8))
    points = draw(st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=count, max_size=count))
    row = st.lists(st.integers(0, count - 1), min_size=3, max_size=6)
    faces = Ragged.of(draw(st.lists(row, max_size=6)))
    corners, total = len(faces.flat), len(faces)

    def corner_values(width):
        size = draw(st.integers(1, 4))
        values = draw(st.lists(st.tuples(*[coordinates] * width), min_size=size, max_size=size))
        indices = draw(st.lists(st.integers(-1, size - 1), min_size=corners, max_size=corners))
        return CornerValues(np.array(values), np.array(indices, np.int32)) if max(indices, default=-1) >= 0 else None

    def labels():
        words = draw(st.lists(names, min_size=1, max_size=3, unique=True))
        indices = draw(st.lists(st.integers(0, len(words) - 1), min_size=total, max_size=total))
        return FaceLabels(tuple(words), np.array(indices, np.int32)) if total else None

    return PolygonMesh(
        points,
        faces,
        uvs=corner_values(2) if draw(st.booleans()) else None,
        normals=corner_values(3) if draw(st.booleans()) else None,
        groups=labels() if draw(st.booleans()) else None,
        objects=labels() if draw(st.booleans()) else None,
        materials=labels() if draw(st.booleans()) else None,
        lines=Ragged.of(
            draw(st.lists(st.lists(st.integers(0, count - 1), min_size=2, max_size=4), min_size=1, max_size=3))
        )
        if draw(st.booleans())
        else None,
    )


def same_labels(a, b):
    if a is None or b is None:
        return a is b
    return [a.names[i] for i in a.indices] == [b.names[i] for i in b.indices]


def same_corners(a, b):
    if a is None or b is None:
        return a is b
    return np.array_equal(a.per_corner, b.per_corner, equal_nan=True)


def same_rows(a, b):
    return [row.tolist() for row in a] == [row.tolist() for row in b]


quick = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])


@quick
@given(meshes())
def test_obj_holds_everything(tmp_path, mesh):
    path = tmp_path / "mesh.obj"
    assert not pl.write(mesh, path).losses
    again = pl.read(path)
    assert again.points.tobytes() == mesh.points.tobytes()
    assert same_rows(mesh.faces, again.faces)
    for name in ("uvs", "normals"):
        assert same_corners(getattr(mesh, name), getattr(again, name))
    for name in ("groups", "objects", "materials"):
        assert same_labels(getattr(mesh, name), getattr(again, name))
    assert mesh.lines is None or same_rows(mesh.lines, again.lines)


@quick
@given(meshes(), st.sampled_from(["ply", "off"]))
def test_polygons_and_points_are_exact_elsewhere(tmp_path, mesh, ending):
    path = tmp_path / f"mesh.{ending}"
    pl.write(mesh, path)
    again = pl.read(path)
    assert again.points.tobytes() == mesh.points.tobytes()
    assert same_rows(mesh.faces, again.faces)


@quick
@given(meshes(), st.sampled_from(ENDINGS), st.data())
def test_a_round_trip_changes_the_points_and_nothing_else(tmp_path, mesh, ending, data):
    pl.write(mesh, tmp_path / f"first.{ending}")
    original = (tmp_path / f"first.{ending}").read_bytes()
    read = pl.read(tmp_path / f"first.{ending}")
    moved = read.with_points(read.points + data.draw(coordinates))
    report = pl.write(moved, tmp_path / f"second.{ending}", strict=True)
    again = pl.read(report.path)
    assert np.allclose(again.points, moved.points, rtol=1e-6)
    assert same_rows(again.faces, read.faces)
    pl.write(again.with_points(read.points), tmp_path / f"third.{ending}")
    third = pl.read(tmp_path / f"third.{ending}")
    assert third.points.tobytes() == read.points.tobytes()
    pl.write(read, tmp_path / f"same.{ending}", strict=True)
    assert (tmp_path / f"same.{ending}").read_bytes() == original


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_read_from_memory_is_the_same_mesh(box_mesh, ending, tmp_path):
    pl.write(box_mesh, tmp_path / f"box.{ending}")
    data = (tmp_path / f"box.{ending}").read_bytes()
    assert np.array_equal(read_mesh_bytes(data, "memory").points, pl.read(tmp_path / f"box.{ending}").points)
