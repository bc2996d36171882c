"""zxhproj affine maps: the matrix decides, the parameters are kept, and files come back byte for byte."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidParameter, LossRefused, UnreadableFile, UnsupportedFormat
from pliant.mesh import PolygonMesh

POINTS = np.random.default_rng(4).normal(size=(30, 3)) * 50


def rotation(axis, degrees):
    """About x, y or z, right-handed."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = cosine, -sine, sine, cosine
    return matrix


def row(values):
    return "".join(f"{value:f}\t" for value in values) + "\n"


def aff(angles=(0.4, 0.3, -0.2), center=(6.5, 26.2, -205.0), translation=(3, -2, 14)):
    """The text of a rigid motion as zxhproj writes it: x' = R (x - c) + c + t, and the motion."""
    a, b, c = angles
    turn = rotation(0, -a) @ rotation(1, -b) @ rotation(2, -c)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, np.add(center, translation) - turn @ center
    text = f"#dimension#\n3\n#one to one#\n1\n#rotation center#\n{row(center)}#rotation angle#\n{row(angles)}"
    text += f"#scaling#\n{row((1, 1, 1))}#translation#\n{row(translation)}"
    for name in ("x-y and y-x", "y-z and z-y", "z-x and x-z"):
        text += f"#skew in {name} plane#\n0.000000\n0.000000\n"
    return text + "#matrix#\n" + "".join(map(row, matrix)), matrix


def read(path, text, **options):
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return pl.read_transform(path, **options)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "rigid.AFF"


def test_the_matrix_is_the_map(path):
    text, matrix = aff()
    deformer = read(path, text)
    assert np.allclose(deformer(POINTS), POINTS @ matrix[:3, :3].T + matrix[:3, 3], atol=2e-4)
    assert np.allclose(deformer.inverse(deformer(POINTS)), POINTS)
    assert deformer.direction == "pull-back"
    assert deformer.carrier.parameters["rotation angle"].split() == ["0.400000", "0.300000", "-0.200000"]


def test_blocks_may_come_in_any_order(path):
    text, _ = aff()
    at = text.index("#scaling#")
    assert (read(path, text[at:] + text[:at]).matrix == read(path, text.replace("\n", "\r\n")).matrix).all()


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_comes_back_byte_for_byte(path, ending):
    deformer = read(path, aff()[0].replace("\n", ending))
    copy = path.with_name("copy.aff")
    report = pl.write_transform(deformer, copy)
    assert copy.read_bytes() == path.read_bytes()
    assert report.losses == report.notes == ()


def test_a_rotation_is_written_with_its_angles(path):
    text, matrix = aff(center=(0, 0, 0))
    report = pl.write_transform(pl.Affine(matrix), path)
    assert path.read_text() == text
    assert any("pull-back" in note for note in report.notes)


@settings(deadline=None, max_examples=40)
@given(st.tuples(*[st.floats(-179, 179)] * 3))
def test_angles_rebuild_any_rotation(tmp_path_factory, angles):
    path = tmp_path_factory.mktemp("aff") / "turn.AFF"
    pl.write_transform(pl.Affine(aff(angles)[1]), path)
    again = pl.read_transform(path)
    written = [float(word) for word in path.read_text().split("#rotation angle#")[1].split("#")[0].split()]
    assert np.allclose(aff(written)[1][:3, :3], again.linear, atol=2e-6)


def test_a_singular_turn_of_b_is_no_trouble(path):
    for b in (90, -90):
        _, matrix = aff((20, b, 30))
        pl.write_transform(pl.Affine(matrix), path)
        written = [float(word) for word in path.read_text().split("#rotation angle#")[1].split("#")[0].split()]
        assert np.allclose(aff(written)[1][:3, :3], matrix[:3, :3], atol=1e-6)


def test_a_changed_map_keeps_the_matrix_true(path):
    deformer = read(path, aff()[0])
    sheared = deformer.moved(deformer.controls + 0.125 * np.eye(1, 12, 1)[0])
    report = pl.write_transform(sheared, path)
    assert np.allclose(pl.read_transform(path).matrix, sheared.matrix, atol=1e-6)
    assert any("translation only" in note for note in report.notes)


def test_a_matrix_too_small_for_six_decimals_is_a_loss(path):
    with pytest.raises(LossRefused, match="six decimals"):
        pl.write_transform(pl.Affine.scaling(1.23456e-4), path, strict=True)
    assert not path.exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("0.000000\t0.000000\t0.000000\t1.000000", "0.000000\t0.000000\t1.000000\t1.000000"), "last row"),
        (("#matrix#", "#matrix#\n1"), "line 27: #matrix# holds 17 numbers; 16"),
        (("1.000000\t\n", "nan\t\n"), "'nan' is not a finite number"),
        (("#matrix#", "#other#"), "there is no #matrix#"),
    ],
)
def test_contradictions_are_refused(path, change, message):
    text = aff()[0]
    head, _, tail = text.partition("#skew")
    broken = head + "#skew" + tail.replace(*change)
    with pytest.raises(UnreadableFile, match=message):
        read(path, broken)


def test_an_affine_map_has_nothing_to_fit(path):
    with pytest.raises(InvalidParameter, match="no lattice"):
        read(path, aff()[0], placement="fit", target=PolygonMesh(POINTS))


def test_holds_affine_maps_only(path):
    lattice = pl.BSplineFFD.around(POINTS, shape=(4, 4, 4))
    with pytest.raises(UnsupportedFormat, match=r"\.FFD"):
        pl.write_transform(lattice, path)
    with pytest.raises(UnsupportedFormat, match=r"rigid\.AFF"):
        pl.write_transform(pl.Affine(), path.with_suffix(".FFD"))


def test_mutants_are_read_or_refused(path):
    rng = np.random.default_rng(12)
    original = aff()[0].encode()
    for _ in range(200):
        data = bytearray(original)
        at = int(rng.integers(len(data)))
        if rng.random() < 0.5:
            data[at] = int(rng.integers(256))
        else:
            del data[at : at + int(rng.integers(1, 40))]
        try:
            deformer = read(path, bytes(data))
        except pl.PliantError:
            continue
        assert np.isfinite(deformer.matrix).all()
