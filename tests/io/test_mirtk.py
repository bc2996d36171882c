"""MIRTK's files, written by hand here, type by type; and ours, byte for byte what the types say."""

from __future__ import annotations

import gzip
import struct

import numpy as np
import pytest

import pliant as pl
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.map_formats.mirtk_matrices import matrix_of, parameters_of
from pliant.space.compose import Composition, compose
from pliant.space.summed import Summed

AXES = pl.Affine.rotation((1, -2, 3), 0.6).linear
SHAPE = (4, 3, 5)
CENTER, SPACING = np.array([10.0, 20, 30]), np.array([2.0, 3, 4])
MOVES = np.random.default_rng(0).normal(size=(*SHAPE, 3)) * 0.3


def head(kind):
    return struct.pack(">II", 815007, kind)


def linear(kind, *numbers):
    return head(kind) + struct.pack(f">i{len(numbers)}d", len(numbers), *numbers)


def lattice(kind, moves=MOVES, mode=2):
    count = 2 if kind == 4 else 3
    data = head(kind) + struct.pack(">3i", *moves.shape[:3])
    data += struct.pack(f">{3 * count}d", *AXES.T[:count].reshape(-1)) + struct.pack(">6d", *SPACING, *CENTER)
    data += struct.pack(">I", mode) if kind >= 70 else b""
    for outer in np.ndindex(*(moves.shape[:3] if kind < 50 else moves.shape[2::-1])):
        data += struct.pack(">3d", *moves[outer if kind < 50 else outer[::-1]])
    return data + bytes(4 * moves.size)


def expected(edge="zero", moves=MOVES, affine=None):
    origin = CENTER - AXES @ ((np.array(moves.shape[:3]) - 1) / 2 * SPACING)
    affine = np.eye(4) if affine is None else affine
    return pl.BSplineFFD(displacements=moves, origin=origin, spacing=SPACING, axes=AXES, edge=edge, affine=affine)


def points(beyond=5):
    low, high = -beyond, np.array(SHAPE) - 1 + beyond
    return expected().origin + (np.random.default_rng(1).uniform(low, high, (300, 3)) * SPACING) @ AXES.T


def reading(tmp_path, data, **choices):
    path = tmp_path / "a.dof.gz"
    path.write_bytes(gzip.compress(data))
    first = pl.read_transform(path, **choices)
    (tmp_path / "a.dof").write_bytes(data)
    assert np.array_equal(pl.read_transform(tmp_path / "a.dof", **choices)(points()), first(points()))
    return first


@pytest.mark.parametrize("kind", [76, 56, 12, 4])
@pytest.mark.parametrize("edge", ["zero", "clamp"])
def test_lattices_of_every_type(tmp_path, kind, edge):
    read = reading(tmp_path, lattice(kind, mode={"zero": 2, "clamp": 3}[edge]), edge=edge)
    assert np.abs(read(points()) - expected(edge)(points())).max() < 1e-13
    assert read.direction == "pull-back"


def test_the_current_type_says_its_edge_itself(tmp_path):
    assert reading(tmp_path, lattice(76, mode=3), edge="zero").edge == "clamp"
    with pytest.raises(UnsupportedFormat, match="mirrored"):
        reading(tmp_path, lattice(76, mode=5))


def test_rigid_similarity_and_affine_maps(tmp_path):
    rx, ry, rz = np.radians([10, -20, 30])
    cx, cy, cz, sx, sy, sz = np.cos(rx), np.cos(ry), np.cos(rz), np.sin(rx), np.sin(ry), np.sin(rz)
    turn = np.array([  # IRTK's rotation, spelled out
        [cy * cz, cy * sz, -sy],
        [sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy],
        [cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy],
    ])  # fmt: skip
    rigid = (1, 2, 3, 10, -20, 30)
    assert np.allclose(reading(tmp_path, linear(2, *rigid)).matrix[:3], np.column_stack([turn, [1, 2, 3]]))
    assert np.allclose(reading(tmp_path, linear(22, *rigid, 120)).linear, 1.2 * turn)
    assert np.allclose(reading(tmp_path, linear(3, *rigid, 110, 120, 90)).linear, turn * [1.1, 1.2, 0.9])
    shear = np.array([[1, np.tan(0.1), np.tan(0.3)], [0, 1, np.tan(0.2)], [0, 0, 1]])
    full = (*rigid, 110, 120, 90, *np.degrees([0.1, 0.2, 0.3]))
    assert np.allclose(reading(tmp_path, linear(3, *full)).linear, turn @ shear * [1.1, 1.2, 0.9])


def test_every_regular_matrix_has_parameters(random):
    for _ in range(50):
        matrix = np.eye(4)
        matrix[:3] = random.normal(size=(3, 4))
        assert np.abs(matrix_of(parameters_of(matrix)) - matrix).max() < 1e-12


def test_levels_add_up_and_fluid_levels_follow_one_another(tmp_path):
    affine = (1, 2, 3, 10, -20, 30, 110, 120, 90, 1, 2, 3)
    second = np.random.default_rng(5).normal(size=(2, 3, 2, 3))
    body = struct.pack(">i", 2) + linear(3, *affine) + lattice(76) + lattice(56, second)
    added = reading(tmp_path, head(7) + body, edge="zero")
    a, one, two = matrix_of(np.array(affine, float)), expected(), expected(moves=second)
    x = points()
    moved = x @ a[:3, :3].T + a[:3, 3]
    assert np.abs(added(x) - (moved + one(x) - x + two(x) - x)).max() < 1e-12
    for kind in (8, 81):
        last = linear(2, 1, 1, 1, 5, 0, 0) if kind == 81 else b""
        fluid = reading(tmp_path, head(kind) + body + last, edge="zero")
        after = matrix_of(np.array([1, 1, 1, 5, 0, 0.0])) if kind == 81 else np.eye(4)
        assert np.abs(fluid(x) - (two(one(moved)) @ after[:3, :3].T + after[:3, 3])).max() < 1e-12
    assert isinstance(reading(tmp_path, head(7) + struct.pack(">i", 0) + linear(3, *affine)), pl.Affine)


@pytest.mark.parametrize("ending", [".dof", ".dof.gz"])
def test_ours(tmp_path, ending, random):
    affine = np.eye(4)
    affine[:3] += random.normal(size=(3, 4)) * 0.1
    path, x = tmp_path / f"ours{ending}", points()
    second = expected("clamp", np.random.default_rng(5).normal(size=(2, 3, 2, 3)))
    for deformer in (
        expected("zero"),
        expected("clamp"),
        expected("clamp", affine=affine),
        pl.Affine(affine),
        Summed((expected("zero", affine=affine), second)),
        compose(pl.Affine(affine), expected("zero"), second, pl.Affine(affine)),
        compose(expected("zero"), second),
    ):
        assert not pl.write_transform(deformer, path, strict=True).losses
        again = pl.read_transform(path)
        assert np.abs(again(x) - deformer(x)).max() < 1e-12
        assert isinstance(again, type(deformer) if not isinstance(deformer, Composition) else Composition)


def test_the_current_type_is_written_as_by_hand(tmp_path):
    path = tmp_path / "ours.dof"
    pl.write_transform(expected("zero"), path)
    assert path.read_bytes() == lattice(76)


def test_what_mirtk_cannot_hold(tmp_path):
    with pytest.raises(UnsupportedFormat, match="BezierFFD"):
        pl.write_transform(pl.BezierFFD.around(np.eye(3)), tmp_path / "a.dof")
    ffd = pl.BSplineFFD(displacements=np.ones((4, 4, 4, 3)), origin=(0, 0, 0), spacing=(1, 1, 1), edge="identity")
    assert "edge" in pl.write_transform(ffd, tmp_path / "a.dof").losses[0]


@pytest.mark.parametrize(
    ("data", "error", "message"),
    [
        (lattice(76)[:-1], UnreadableFile, "ends at byte"),
        (lattice(76)[:40], UnreadableFile, "ends at byte"),
        (head(76) + struct.pack(">3i", 2**30, 2**30, 2**30) + bytes(200), UnreadableFile, "spacing|ends|finite"),
        (head(76) + struct.pack(">3i", 0, 1, 1) + bytes(200), UnreadableFile, "control points"),
        (head(78) + bytes(99), UnsupportedFormat, "type 78"),
        (linear(3, 1, 2), UnreadableFile, "2 parameters"),
        (linear(3, *[0] * 12), UnreadableFile, "flattens"),
        (linear(3, *[np.nan] * 12), UnreadableFile, "not finite"),
        (head(7) + struct.pack(">i", -5), UnreadableFile, "-5 levels"),
        (head(7) + struct.pack(">i", 1) + lattice(76), UnreadableFile, "stands where an affine"),
        (
            head(7) + struct.pack(">i", 1) + linear(2, 0, 0, 0, 0, 0, 0) + head(77),
            UnsupportedFormat,
            "level of type 77",
        ),
    ],
)
def test_damaged_files(tmp_path, data, error, message):
    path = tmp_path / "bad.dof.gz"
    path.write_bytes(gzip.compress(data))
    with pytest.raises(error, match=message):
        pl.read_transform(path)


def test_damaged_compression(tmp_path):
    path = tmp_path / "bad.dof.gz"
    packed = gzip.compress(lattice(76))
    path.write_bytes(packed[: len(packed) // 2])
    with pytest.raises(UnreadableFile, match="cut off"):
        pl.read_transform(path)
    path.write_bytes(packed[:500] + b"garbage" + packed[507:])
    with pytest.raises(UnreadableFile, match="damaged"):
        pl.read_transform(path)
