"""Landmark files: round trips, what programs write, what formats cannot hold, and damaged files."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidParameter, LossRefused, UnreadableFile, UnsupportedFormat
from pliant.io.landmarks import Landmarks, read_landmarks, write_landmarks

ENDINGS = [".csv", ".json", ".mrk.json", ".fcsv"]
POINTS = np.array([[1.5, -2.25, 1e-7], [-53.388409961685827, 0.1, 240.65634155273438]])

names = st.lists(
    st.text(max_size=8).map(lambda name: " ".join(name.split())).filter(lambda name: name.isprintable() and name),
    min_size=1,
    max_size=5,
    unique=True,
)


@settings(deadline=None, max_examples=30)
@given(names, st.integers(0, 1000), st.sampled_from(ENDINGS), st.sampled_from(["RAS", "LPS", None]))
def test_a_round_trip_changes_nothing(tmp_path_factory, names, seed, ending, space):
    path = tmp_path_factory.mktemp("landmarks") / f"a{ending}"
    points = np.random.default_rng(seed).normal(size=(len(names), 3)) * 100
    given = Landmarks(names, points, space, [f"number, {i}" for i in range(len(names))])
    report = write_landmarks(given, path)
    again = read_landmarks(path)
    assert again.names == tuple(names)
    assert (again.points == points).all()
    assert again.descriptions == given.descriptions
    if ending in (".mrk.json", ".fcsv"):
        assert again.space == (space or "RAS")
        assert bool(report.notes) == (space is None)
        assert not report.losses
    else:
        assert again.space is None
        assert len(report.losses) == (space is not None)


def test_uncertainties_go_through_scalismo(tmp_path):
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    covariance = turn @ np.diag([9.0, 4.0, 1.0]) @ turn.T
    given = Landmarks(["a", "b"], POINTS, covariances=np.stack([covariance, np.full((3, 3), np.nan)]))
    assert not write_landmarks(given, tmp_path / "a.json").losses
    again = read_landmarks(tmp_path / "a.json")
    assert np.allclose(again.covariances, given.covariances, equal_nan=True)
    written = json.loads((tmp_path / "a.json").read_text())
    assert np.allclose(written[0]["uncertainty"]["stddevs"], [3, 2, 1])
    assert "uncertainty" not in written[1]
    with pytest.raises(LossRefused, match="uncertainties of 1"):
        write_landmarks(given, tmp_path / "a.csv", strict=True)
    assert not (tmp_path / "a.csv").exists()


def test_slicer_files_as_slicer_writes_them(tmp_path):
    markups = tmp_path / "a.mrk.json"
    point = {"label": "F-1", "position": [1, 2, 3.5], "positionStatus": "defined", "description": "tip"}
    unset = {"label": "F-2", "position": [0, 0, 0], "positionStatus": "undefined"}
    markups.write_text(
        json.dumps({"markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": [point, unset]}]})
    )
    read = read_landmarks(markups)
    assert (read.names, read.points.tolist(), read.space, read.descriptions) == (
        ("F-1",),
        [[1, 2, 3.5]],
        "LPS",
        ("tip",),
    )
    markups.rename(tmp_path / "a.json")
    assert read_landmarks(tmp_path / "a.json").space == "LPS"

    new, old = tmp_path / "new.fcsv", tmp_path / "old.fcsv"
    head = "# Markups fiducial file version = {}\n# CoordinateSystem = {}\n# columns = {}\n"
    columns = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID"
    new.write_text(head.format("4.13", "LPS", columns) + '0,-19.9,13.9,29.4,0,0,0,1,1,1,0,"F,1",,\n')
    old.write_text(head.format("4.6", "0", columns) + "vtkMRML_0,1,2,3,0,0,0,1,1,1,0,nose,left,vtkMRML\n")
    assert (read_landmarks(new).names, read_landmarks(new).space) == (("F,1",), "LPS")
    assert (read_landmarks(old).names, read_landmarks(old).space) == (("nose",), "RAS")
    assert read_landmarks(old).descriptions == ("left",)


@pytest.mark.parametrize(
    "text",
    [
        "a,1,2,3\nb,4,5,6\n",
        "name,x,y,z\na,1,2,3\nb,4,5,6\n",
        "x,z,y,label\n1,3,2,a\n4,6,5,b",
        "# made by hand\n\na;1;2;3\r\nb;4;5;6\r\n",
        "\ufefflabel\tx\ty\tz\na\t1\t2\t3\nb\t4\t5\t6\n",
    ],
)
def test_tables_in_many_dresses(tmp_path, text):
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode())
    read = read_landmarks(path)
    assert read.names == ("a", "b")
    assert read.points.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_points_without_names_are_counted(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("1,2,3\n4,5,6\n")
    assert read_landmarks(path).names == ("1", "2")


def test_spaces_are_turned_into_one_another():
    lps = Landmarks(["a", "b"], POINTS, "LPS", covariances=np.arange(18.0).reshape(2, 3, 3))
    ras = lps.in_space("RAS")
    assert (ras.points == POINTS * [-1, -1, 1]).all()
    assert ras.covariances[0].tolist() == [[0, 1, -2], [3, 4, -5], [-6, -7, 8]]
    assert (ras.in_space("LPS").points == POINTS).all()
    assert (lps.in_space("LPS").points == POINTS).all()
    with pytest.raises(InvalidParameter, match="say so first"):
        Landmarks(["a", "b"], POINTS).in_space("RAS")


def test_landmarks_are_found_and_paired_by_name():
    one, two = Landmarks("abc", np.eye(3)), Landmarks("cxa", 2 * np.eye(3))
    assert one["b"].tolist() == [0, 1, 0]
    names, here, there = one.common(two)
    assert names == ("a", "c")
    assert here.tolist() == [[1, 0, 0], [0, 0, 1]]
    assert there.tolist() == [[0, 0, 2], [2, 0, 0]]
    with pytest.raises(InvalidParameter, match="no landmark 'z'"):
        one["z"]


@pytest.mark.parametrize(
    ("ending", "content", "cause"),
    [
        (".json", "[{", "no JSON"),
        (".json", "3", "no list"),
        (".json", '[{"id": "a"}]', "entry 0 has no coordinates"),
        (".json", '[{"id": "a", "coordinates": [1, 2]}]', "'a'"),
        (".json", '[{"id": "a", "coordinates": [1, 2, "x"]}]', "three finite numbers"),
        (".json", '[{"id": "a", "coordinates": [1, 2, 3], "uncertainty": {"stddevs": [1]}}]', "uncertainty"),
        (".mrk.json", "[]", "no markups"),
        (".mrk.json", '{"markups": [{"coordinateSystem": "XYZ"}]}', "XYZ"),
        (".mrk.json", '{"markups": [{"controlPoints": [3]}]}', "control point 0"),
        (".mrk.json", '{"markups": [{"controlPoints": [{"label": "a"}]}]}', "'a'"),
        (".csv", "# nothing\n", "no landmarks"),
        (".csv", "a,1,2,3\nb,4,5\n", "line 2"),
        (".csv", "a,1,2,3\nb,4,5,nan\n", "line 2"),
        (".csv", 'a,1,2,3\n"b,4,5,6\n', "line 2"),
        (".fcsv", "# CoordinateSystem = up\n", "'up'"),
        (".fcsv", "# columns = id,x,y\n", "no column 'z'"),
        (".fcsv", "a,1,2\n", "three finite numbers"),
        (".csv", "", "empty"),
    ],
)
def test_damaged_files_name_the_place(tmp_path, ending, content, cause):
    path = tmp_path / f"a{ending}"
    path.write_text(content)
    with pytest.raises(UnreadableFile, match=cause):
        read_landmarks(path)


def test_other_refusals(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"a,1,2,\xff\xfe")
    with pytest.raises(UnreadableFile, match="byte 6"):
        read_landmarks(tmp_path / "a.csv")
    with pytest.raises(UnreadableFile):
        read_landmarks(tmp_path / "missing.csv")
    with pytest.raises(UnsupportedFormat, match=r"\.mrk\.json"):
        read_landmarks(tmp_path / "a.txt")
    for build, cause in (
        (lambda: Landmarks(["a\nb"], POINTS), "2 landmarks have 1 names"),
        (lambda: Landmarks(["a", "b"], POINTS * np.nan), "'a' is not finite"),
        (lambda: Landmarks(["a", "b"], POINTS, "XYZ"), "XYZ"),
        (lambda: Landmarks(["a", "b"], POINTS, descriptions=["x"]), "one entry"),
    ):
        with pytest.raises(InvalidParameter, match=cause):
            build()
