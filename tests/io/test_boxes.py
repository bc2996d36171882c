"""PyGeM's and Plot3D's boxes: their own formulas, spelled out; and ours, which read back as they were."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

import pliant as pl
from pliant.errors import PliantWarning, UnreadableFile, UnsupportedFormat
from pliant.io.map_formats import plot3d as plot3d_module
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.space.clamped_ffd import ClampedFFD

PRM = """
[Box info]
# comments are kept out
n control points x: 3
n control points y: 2
n control points z: 2

box length x: 2.0
box length y: 1.5
box length z: 3.0

box origin x: -20.0
box origin y: -55.0
box origin z: -45.0

rotation angle x: 20.3
rotation angle y: 11.0
rotation angle z: -5

[Parameters weights]
parameter x:    0   0   0   0.2
               2   1   1   -0.3

parameter y:    1   0   1   0.5

parameter z:    0   1   0   0.25
"""


def by_pygem(points):
    """Into the unit box, weights summed with Bernstein polynomials, and back."""
    a, b, c = np.radians([20.3, 11.0, -5])
    rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    ry = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    rz = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    box = rz @ ry @ rx @ np.diag([2.0, 1.5, 3.0])
    weights = np.zeros((3, 2, 2, 3))
    weights[0, 0, 0, 0], weights[2, 1, 1, 0], weights[1, 0, 1, 1], weights[0, 1, 0, 2] = 0.2, -0.3, 0.5, 0.25
    result = []
    for point in points:
        t = np.linalg.solve(box, point - [-20, -55, -45])
        moved = t.copy()
        if (t >= 0).all() and (t <= 1).all():
            for index in np.ndindex(3, 2, 2):
                share = [
                    comb(n - 1, i) * u**i * (1 - u) ** (n - 1 - i) for i, n, u in zip(index, (3, 2, 2), t, strict=True)
                ]
                moved += np.prod(share) * weights[index]
        result.append(box @ moved + [-20, -55, -45])
    return np.array(result)


def test_what_pygem_means(tmp_path, random):
    path = tmp_path / "box.prm"
    path.write_text(PRM)
    read = pl.read_transform(path)
    points = read.origin + random.uniform(-0.2, 1.2, (300, 3)) @ read.edges.T
    assert np.abs(read(points) - by_pygem(points)).max() < 1e-12
    again = tmp_path / "again.prm"
    assert not pl.write_transform(read, again, strict=True).losses
    assert np.abs(pl.read_transform(again)(points) - read(points)).max() < 1e-12


@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi / 2])
def test_our_boxes_in_any_direction(tmp_path, random, angle):
    path = tmp_path / "ours.prm"
    box = pl.BezierFFD.around(random.normal(size=(50, 3)), (4, 3, 5), axes=pl.Affine.rotation("y", angle).linear)
    ours = box.moved(box.rest + random.normal(size=box.rest.shape))
    pl.write_transform(ours, path, strict=True)
    points = random.normal(size=(200, 3)) * 2
    again = pl.read_transform(path)
    inside = np.linalg.solve(ours.edges, (points - ours.origin).T).T
    away = (np.abs(inside * (inside - 1)) > 1e-9).all(axis=1)
    assert np.abs(again(points[away]) - ours(points[away])).max() < 1e-11


def test_what_pygem_cannot_hold(tmp_path):
    path, points = tmp_path / "a.prm", np.eye(3)
    with pytest.raises(UnsupportedFormat, match="patches"):
        pl.write_transform(pl.BezierFFD.around(points, patches=(2, 1, 1)), path)
    with pytest.raises(UnsupportedFormat, match="right-handed"):
        pl.write_transform(pl.BezierFFD(displacements=np.zeros((2, 2, 2, 3)), origin=(0, 0, 0), edges=-np.eye(3)), path)
    with pytest.raises(UnsupportedFormat, match="Affine"):
        pl.write_transform(pl.Affine(), path)
    on = pl.BezierFFD(displacements=np.ones((2, 2, 2, 3)), origin=(0, 0, 0), edges=np.eye(3), outside="extend")
    assert "outside the box" in pl.write_transform(on, path).losses[0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("n control points x: 3", "", "n control points x"),
        ("x: 3", "x: 0", "lattice of"),
        ("x: 3", "x: 900000000", "lattice of"),
        ("box length y: 1.5", "box length y: -1", "positive"),
        ("box length y: 1.5", "box length y: wide", "wide"),
        ("2   1   1   -0.3", "3   1   1   -0.3", "no control point"),
        ("2   1   1   -0.3", "2   1   1", "lines of four"),
        ("[Parameters weights]", "[Other]", "parameter x"),
    ],
)
def test_damaged_parameters(tmp_path, old, new, message):
    path = tmp_path / "bad.prm"
    path.write_text(PRM.replace(old, new))
    with pytest.raises(UnreadableFile, match=message):
        pl.read_transform(path)


def plot3d(controls):
    rows = [" ".join(map(repr, controls[..., c].transpose(2, 1, 0).reshape(-1).tolist())) for c in range(3)]
    return "1\n{} {} {}\n".format(*controls.shape[:3]) + "\n".join(rows) + "\n"


@pytest.mark.parametrize("ending", [".xyz", ".fmt"])
@pytest.mark.parametrize("shape", [(3, 4, 2), (6, 5, 2), (8, 9, 7)])
def test_a_box_at_rest_is_the_identity(tmp_path, random, shape, ending):
    box = ClampedFFD.around(random.normal(size=(50, 3)), shape=shape)
    path = tmp_path / f"box{ending}"
    path.write_text(plot3d(box.rest))
    points = random.normal(size=(100, 3))
    assert np.array_equal(pl.read_transform(path)(points), points)


@pytest.mark.parametrize("shape", [(3, 4, 2), (6, 5, 2), (8, 9, 7)])
def test_moved_boxes_go_both_ways(tmp_path, random, shape):
    box = ClampedFFD.around(random.normal(size=(50, 3)), shape=shape)
    moves = random.normal(size=box.rest.shape) * 0.2
    for corner in ((0, 0, 0), (-1, 0, 0), (0, -1, 0), (0, 0, -1)):
        moves[corner] = 0
    ours, path = box.moved(box.rest + moves), tmp_path / "box.xyz"
    assert not pl.write_transform(ours, path, strict=True).losses
    assert path.read_text().split()[:4] == ["1", *map(str, shape)]
    first = np.array(path.read_text().split()[4:], float).reshape(3, *reversed(shape))
    assert np.array_equal(first.transpose(3, 2, 1, 0), ours.controls)
    with pytest.warns(PliantWarning, match="corners"):
        again = pl.read_transform(path)
    points = box.origin + random.uniform(0.001, 0.999, (200, 3)) @ box.edges.T
    assert np.abs(again(points) - ours(points)).max() < 1e-12
    assert isinstance(again, ClampedFFD if max(shape) > 4 else pl.BezierFFD)


def test_moved_corners_are_a_loss(tmp_path):
    box = ClampedFFD.around(np.eye(3), shape=(5, 5, 5))
    moved = box.rest.copy()
    moved[-1, 0, 0] += 0.1
    assert "box at rest" in pl.write_transform(box.moved(moved), tmp_path / "a.xyz").losses[0]
    with pytest.raises(UnsupportedFormat, match="BSplineFFD"):
        pl.write_transform(pl.BSplineFFD.around(np.eye(3)), tmp_path / "a.xyz")


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        ("2\n2 2 2\n2 2 2\n" + "0 " * 48, UnsupportedFormat, "2 blocks"),
        ("1\n2 2 2\n" + "0 " * 23, UnreadableFile, "23 numbers; 24 are expected"),
        ("1\n99999 99999 99999\n0 0 0", UnreadableFile, "numbers"),
        ("1\n2 2 2\n" + "0 " * 24, UnreadableFile, "span"),
        ("1\n2 2 1\n" + "0 " * 12, UnsupportedFormat, "two an axis"),
        ("1\n2 2 2\n" + "0 " * 23 + "nan", UnreadableFile, "nan"),
        ("1\n2 2", UnreadableFile, "sizes"),
    ],
)
def test_damaged_boxes(tmp_path, text, error, message):
    path = tmp_path / "bad.fmt"
    with pytest.raises(error, match=message):
        plot3d_module.read(path, text.encode(), ReadOptions())
