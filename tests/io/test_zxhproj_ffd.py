"""zxhproj lattices: what the files mean, in every variant, and that they come back byte for byte."""

from __future__ import annotations

import warnings

import nibabel as nib
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget, PliantWarning, UnreadableFile
from pliant.mesh import PolygonMesh

HEADER = "#dimension#\n3\n#one to one#\n{one}\n#control grid size#\n{nx}\n{ny}\n{nz}\n#control grid spacing#\n"
TITLE = "#offsets of the control points#"
QUATERNION = "#quaternion qf,qb,qc,qd,qx,qy,qz#"

RNG = np.random.default_rng(7)
OFFSETS = np.round(RNG.normal(size=(3, 4, 5, 3)), 6)
CUBE = np.round(RNG.normal(size=(4, 4, 4, 3)), 6)
SPACING = np.array([10.0, 12.5, 8.0])
OBLIQUE = (-1.0, 0.5, 0.1, -0.3, 12.25, -40.0, 3.5)
POINTS = RNG.uniform(-60, 60, size=(80, 3))  # in the lattice and outside of it


def read(path, text, **options):
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return pl.read_transform(path, **options)


def ffd(offsets, spacing=(10, 10, 10), quaternion=(1, 0, 0, 0, 0, 0, 0), variant="A", number="%f", one="1"):
    """The text of a file as other programs write it; ``offsets`` are (nx, ny, nz, 3) along the lattice axes."""
    nx, ny, nz, _ = offsets.shape
    text = HEADER.format(one=one, nx=nx, ny=ny, nz=nz)
    text += "".join(("%15.6f" if number == "%f" else number) % length + "\n" for length in spacing)
    text += (TITLE.removesuffix("#") if variant == "D" else TITLE) + "\n"
    slabs, rows, along = (nx, ny, nz) if variant == "B" else (nz, ny, nx)
    for slab in range(slabs):
        for row in range(rows):
            for step in range(along):
                at = (slab, row, step) if variant == "B" else (step, row, slab)
                text += " ".join(number % value for value in offsets[at])
                text += "\n" if variant == "D" else "\t"
            text += "" if variant == "D" else "\n"
        text += "" if variant == "D" else "\n"
    if quaternion is not None:
        text += f"{QUATERNION}\n" + "{:f}\t {:f}\t{:f}\t{:f}\t {:f}\t{:f}\t{:f}\n".format(*quaternion)
    return text


def axes_of(quaternion):
    """The lattice axes, columns, by nibabel."""
    qf, b, c, d = quaternion[:4]
    square = 1 - b * b - c * c - d * d
    full = np.array([np.sqrt(square) if square > 1e-7 else 0.0, b, c, d])
    return nib.quaternions.quat2mat(full) * [1, 1, -1 if qf < 0 else 1]


def evaluate(offsets, spacing, quaternion, points, edge):
    """x' = A(p + sum B B B offset), p = A^-1 x: 64 terms a point, in plain loops."""
    frame, origin = axes_of(quaternion), np.array(quaternion[4:], float)
    size = offsets.shape[:3]
    result = np.empty_like(points)
    for n, x in enumerate(points):
        p = frame.T @ (x - origin) / spacing
        cell = np.floor(p).astype(int)
        weight = [basis(t) for t in p - cell]
        total = np.zeros(3)
        for i in range(4):
            for j in range(4):
                for k in range(4):
                    index = np.add(cell, (i - 1, j - 1, k - 1))
                    inside = all(0 <= at < count for at, count in zip(index, size, strict=True))
                    if edge == "zero" and not inside:
                        continue
                    index = tuple(np.clip(index, 0, np.array(size) - 1))
                    total += weight[0][i] * weight[1][j] * weight[2][k] * offsets[index]
        result[n] = x + frame @ total
    return result


def basis(t):
    """The four uniform cubic B-splines at a parameter."""
    return (1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6


@pytest.fixture
def path(tmp_path):
    return tmp_path / "lattice.FFD"


@pytest.mark.parametrize("edge", ["clamp", "zero"])
@pytest.mark.parametrize("quaternion", [(1, 0, 0, 0, 0, 0, 0), (1, 0, 0, 1, 5, 6, 7), (-1, 0, 1, 0, 1, 2, 3), OBLIQUE])
def test_means_the_sum_of_64_terms(path, quaternion, edge):
    deformer = read(path, ffd(OFFSETS, SPACING, quaternion), edge=edge)
    assert np.allclose(deformer(POINTS), evaluate(OFFSETS, SPACING, quaternion, POINTS, edge), atol=1e-10)
    assert deformer.direction == "pull-back"
    assert deformer.edge == edge


def test_x_runs_along_a_row(path):
    index = np.stack(np.meshgrid(*map(np.arange, (2, 3, 2)), indexing="ij"), axis=-1).astype(float)
    assert (read(path, ffd(index)).displacements == index).all()


def test_equal_offsets_translate_all_of_space(path):
    offset = np.array([1.0, -2.0, 0.5])
    deformer = read(path, ffd(np.broadcast_to(offset, (3, 4, 5, 3)), SPACING, OBLIQUE))
    assert np.allclose(deformer(POINTS), POINTS + axes_of(OBLIQUE) @ offset, atol=1e-12)


@pytest.mark.parametrize("variant", ["A", "B", "D"])
@pytest.mark.parametrize("number", ["%f", "%r"])
def test_variants_are_told_apart_by_rows_and_slabs(path, variant, number):
    text = ffd(OFFSETS, SPACING.tolist(), OBLIQUE, variant=variant, number=number)
    deformer = read(path, text.replace("np.float64(", "").replace(")", ""))
    assert deformer.carrier.variant == variant
    assert np.allclose(deformer(POINTS), evaluate(OFFSETS, SPACING, OBLIQUE, POINTS, "clamp"), atol=1e-10)


@pytest.mark.parametrize("shape", [(3, 4, 5), (5, 1, 2), (1, 3, 2), (2, 3, 1), (1, 1, 4)])
@pytest.mark.parametrize("variant", ["A", "B", "D"])
def test_thin_lattices_too(path, shape, variant):
    offsets = np.round(np.random.default_rng(1).normal(size=(*shape, 3)), 6)
    assert np.allclose(read(path, ffd(offsets, variant=variant)).displacements, offsets, atol=1e-12)


def test_six_decimals_and_a_quaternion_decide_for_a(path):
    deformer = read(path, ffd(CUBE))
    assert deformer.carrier.variant == "A"
    assert (deformer.displacements == CUBE).all()


def test_a_guess_is_said_and_can_be_overridden(path):
    with pytest.warns(PliantWarning, match="variant B"):
        deformer = read(path, ffd(CUBE, variant="B", number="%.9f"))
    assert np.allclose(deformer.displacements, CUBE)
    same = read(path, ffd(CUBE, number="%.9f"), variant="A")
    assert np.allclose(same.displacements, CUBE)
    with pytest.warns(PliantWarning, match="variant A"):
        read(path, ffd(CUBE, quaternion=None), origin=(0, 0, 0))


def test_rows_that_fit_no_variant_are_read_as_a_with_a_warning(path):
    text = ffd(OFFSETS)
    head, _, tail = text.partition(TITLE)
    body, _, quaternion = tail.partition("#")
    with pytest.warns(PliantWarning, match="fit no variant"):
        deformer = read(path, head + TITLE + " ".join(body.split()) + "\n#" + quaternion)
    assert (deformer.displacements == OFFSETS).all()


def test_white_space_line_ends_and_order_of_blocks_do_not_matter(path):
    expected = read(path, ffd(OFFSETS, SPACING, OBLIQUE)).displacements
    text = ffd(OFFSETS, SPACING, OBLIQUE)
    size = text.index("#control grid size#")
    for other in (
        text.replace("\n", "\r\n"),
        "\ufeff" + text,
        text.replace("\t", "  "),
        "\n\n" + text + "\n\n",
        text[size:] + text[:size],
        text.replace("#dimension#\n3\n", "#dimension# 3 "),
    ):
        assert (read(path, other).displacements == expected).all()


def test_a_missing_quaternion_asks_for_an_origin(path):
    with pytest.warns(PliantWarning, match="does not say where"):
        deformer = read(path, ffd(OFFSETS, quaternion=None))
    assert (deformer.origin == 0).all()
    origin = np.array([1.0, 2.0, 3.0])
    moved = read(path, ffd(OFFSETS, quaternion=None), origin=origin)
    assert np.allclose(moved(POINTS + origin), deformer(POINTS) + origin)


# ------------------------------------------------------------------ variant C
GRID = np.stack(np.meshgrid(*(np.arange(n, dtype=float) for n in (3, 4, 5)), indexing="ij"), axis=-1)


def test_absolute_positions_are_a_bernstein_lattice(path):
    controls = np.round(GRID + 0.1 * RNG.normal(size=GRID.shape), 6)
    with pytest.warns(PliantWarning, match="variant C"):
        deformer = read(path, ffd(controls, (1, 1, 1)))
    assert isinstance(deformer, pl.BezierFFD)
    assert np.allclose(deformer.rest, GRID)
    assert np.allclose(deformer.controls, controls)
    corners = GRID[::2, ::3, ::4].reshape(-1, 3)
    assert np.allclose(deformer(corners), controls[::2, ::3, ::4].reshape(-1, 3))  # Bernstein interpolates corners


@pytest.mark.parametrize("variant", ["A", "B"])
def test_the_order_of_absolute_positions_shows_in_their_trend(path, variant):
    controls = np.stack(np.meshgrid(*[np.linspace(-1, 1, 4)] * 3, indexing="ij"), axis=-1)
    controls = np.round(controls + 0.05 * np.random.default_rng(2).normal(size=controls.shape), 6)
    deformer = read(path, ffd(controls, (1, 1, 1), variant=variant), variant="C")
    assert np.allclose(deformer.controls, controls)


def test_absolute_positions_are_not_scaled_when_fitted(path):
    controls = np.round(GRID * [2, 3, 4] + 5, 6)
    target = PolygonMesh(np.array([[5, 5, 5], [9, 14, 21.0]]))
    deformer = read(path, ffd(controls, (1, 1, 1)), variant="C", placement="fit", target=target)
    inside = RNG.uniform([5, 5, 5], [9, 14, 21], size=(20, 3))
    assert np.allclose(deformer(inside), inside)  # the target's box is this lattice at rest


def test_offsets_under_a_spacing_of_one_stay_offsets(path):
    assert isinstance(read(path, ffd(OFFSETS, (1, 1, 1))), pl.BSplineFFD)
    forced = read(path, ffd(GRID, (1, 1, 1)), variant="A")
    assert (forced.displacements == GRID).all()


# ------------------------------------------------------------------ two dimensions
@pytest.mark.parametrize("coordinates", [2, 3])
@pytest.mark.parametrize("size_lines", [2, 3])
def test_two_dimensions_are_one_layer(path, coordinates, size_lines):
    flat = np.round(RNG.normal(size=(3, 4, 1, 3)), 6) * [1, 1, 0]
    text = ffd(flat[..., :coordinates]).replace("#dimension#\n3", "#dimension#\n2")
    if size_lines == 2:
        text = text.replace("3\n4\n1\n", "3\n4\n").replace("      10.000000\n", "", 1)
    deformer = read(path, text)
    assert deformer.shape == (3, 4, 1)
    assert np.allclose(deformer.displacements, flat)
    assert np.allclose(deformer(POINTS)[:, 2], POINTS[:, 2])
    copy = path.with_name("copy.FFD")
    pl.write_transform(deformer, copy)
    assert copy.read_bytes() == path.read_bytes()


# ------------------------------------------------------------------ placement
def test_fitting_conjugates_with_the_scaling_of_the_boxes(path):
    quaternion = (1.0, 0.0, 0.0, 0.6, 12.0, -4.0, 3.0)
    text = ffd(OFFSETS, SPACING, quaternion)
    target = PolygonMesh(RNG.normal(size=(30, 3)) * [1, 2, 3] + 5)
    there, here = read(path, text, placement="fit", target=target), read(path, text)
    frame = axes_of(quaternion)
    along = target.points @ frame
    low, extent = along.min(axis=0), np.ptp(along, axis=0)
    length = SPACING * (np.array(OFFSETS.shape[:3]) - 1)
    carry = frame @ np.diag(extent / length) @ frame.T
    shift = frame @ low - carry @ np.array(quaternion[4:])
    assert np.allclose(there(POINTS @ carry.T + shift), here(POINTS) @ carry.T + shift, atol=1e-9)
    corners = there.rest.reshape(-1, 3) @ frame
    assert np.allclose([corners.min(axis=0), corners.max(axis=0)], [low, low + extent])


def test_a_fitted_lattice_can_be_written_where_it_lies(path):
    target = PolygonMesh(RNG.normal(size=(30, 3)) * [10, 20, 30] + 5)
    fitted = read(path, ffd(OFFSETS, SPACING, OBLIQUE), placement="fit", target=target)
    pl.write_transform(fitted, path)
    assert np.allclose(pl.read_transform(path)(POINTS), fitted(POINTS), atol=1e-4)


def test_fitting_a_flat_mesh_keeps_the_mean_scale_across(path):
    square = PolygonMesh(np.array([[0, 0, 7], [2, 0, 7], [2, 3, 7.0]]))
    fitted = read(path, ffd(OFFSETS), placement="fit", target=square)
    assert np.allclose(fitted.spacing[:2], [1, 1])
    assert np.isclose(fitted.spacing[2], 1)
    assert np.isclose(fitted.rest[..., 2].mean(), 7)


def test_fitting_needs_something_to_fit_to(path):
    with pytest.raises(InvalidTarget, match="target="):
        read(path, ffd(OFFSETS), placement="fit")
    with pytest.raises(InvalidTarget, match="no axis"):
        read(path, ffd(OFFSETS), placement="fit", target=PolygonMesh(np.zeros((1, 3))))
    with pytest.raises(InvalidTarget, match="without points"):
        read(path, ffd(OFFSETS), placement="fit", target=PolygonMesh(np.zeros((0, 3))))


def test_choices_are_checked(path):
    for options in ({"placement": "here"}, {"variant": "E"}, {"edge": "wrap"}, {"origin": (1, 2)}, {"origin": "a"}):
        with pytest.raises(InvalidParameter):
            read(path, ffd(OFFSETS), **options)


# ------------------------------------------------------------------ refusals
REFUSALS = {
    "a word": (("#offsets of the control points#\n", "#offsets of the control points#\nabc "), "there are 181 offsets"),
    "not a number": (("#control grid spacing#\n      10.000000", "#control grid spacing#\nnan"), "line 10: 'nan'"),
    "no spacing": (("      10.000000\n", "", 1), "holds 2 numbers; 3 are expected"),
    "a spacing of zero": (("10.000000", "0.000000", 1), "must be positive"),
    "a negative size": (("size#\n3", "size#\n-3"), "line 6: .*positive whole number"),
    "half a size": (("size#\n3", "size#\n3.5"), "positive whole number"),
    "an absurd size": (("size#\n3\n4\n5", "size#\n99999\n99999\n99999"), "180 offsets.*need 2,999,910,000,899,997"),
    "another size": (("size#\n3\n4\n5", "size#\n3\n4\n6"), "180 offsets; 3 x 4 x 6 .* need 216"),
    "another dimension": (("dimension#\n3", "dimension#\n4"), "line 2: the dimension is '4'"),
    "a layered plane": (("dimension#\n3", "dimension#\n2"), "5 layers"),
    "a short quaternion": (("\t 0.000000\t0.000000\t0.000000\n", "\n"), "4 numbers; 7 are expected"),
    "no quaternion": (("\t 0.000000\t0.0", "\t 2.000000\t0.0"), "no part of a unit quaternion"),
    "a number beyond all": (
        ("size#\n3\n4\n5\n#control grid spacing#\n      1", "size#\n3\n4\n5\n#control grid spacing#\n1e200\n"),
        "'1e200' is",
    ),
    "no offsets": (("#offsets of the control points#", "#other#"), "there is no #offsets of the control points#"),
    "a block twice": (("#one to one#", "#dimension#"), "occurs twice"),
    "text before": (("#dimension#", "hello #dimension#"), "before the first"),
    "far too many headers": (("#dimension#", "#" * 300 + "#dimension#"), "64"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_contradictions_are_refused_with_their_place(path, name):
    change, message = REFUSALS[name]
    text = ffd(OFFSETS)
    broken = text.replace(*change)
    assert broken != text
    with pytest.raises(UnreadableFile, match=message) as caught:
        read(path, broken)
    assert str(path) in str(caught.value)


def test_a_lattice_without_any_offset_is_refused(path):
    text = ffd(np.zeros((1, 1, 1, 3))).replace("0.000000 0.000000 0.000000\t", " " * 40)
    with pytest.raises(UnreadableFile, match="there are 0 offsets"):
        read(path, text)


def test_the_line_of_a_missing_offset_is_named(path):
    lines = ffd(OFFSETS).split("\n")
    row = lines.index(TITLE) + 9
    lines[row] = lines[row].rsplit(" ", 1)[0]
    with pytest.raises(UnreadableFile, match=f"line {row + 1}: there are 179 offsets; .* need 180"):
        read(path, "\n".join(lines))


def test_the_line_of_a_bad_number_is_named(path):
    lines = ffd(OFFSETS).split("\n")
    row = lines.index(TITLE) + 9
    for bad in ("1e999", "x", "1_0", "nan", "1,5"):
        changed = list(lines)
        changed[row] = bad + " " + changed[row].split(" ", 1)[1]
        with pytest.raises(UnreadableFile, match=f"line {row + 1}: '{bad}' is not a finite number"):
            read(path, "\n".join(changed))


def test_mutants_are_read_or_refused(path):
    rng = np.random.default_rng(11)
    original = ffd(CUBE, SPACING, OBLIQUE).encode()
    alphabet = b"0123456789.-+eE# \t\r\nx\xff\x00"
    for _ in range(200):
        data = bytearray(original)
        for _ in range(rng.integers(1, 4)):
            at = int(rng.integers(len(data) if rng.random() < 0.6 else min(160, len(data))))
            action = rng.integers(4)
            if action == 0:
                data[at] = alphabet[rng.integers(len(alphabet))]
            elif action == 1:
                del data[at : at + int(rng.integers(1, 60))]
            elif action == 2:
                data[at:at] = bytes(rng.choice(list(alphabet), size=3).astype(np.uint8))
            else:
                del data[at:]
                data = data or bytearray(b" ")
        survives(path, bytes(data))


def survives(path, data):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        try:
            deformer = read(path, data)
        except pl.PliantError:
            return
    assert np.isfinite(deformer.controls).all()
    assert np.isfinite(deformer(POINTS)).all()


# ------------------------------------------------------------------ writing
def test_comes_back_byte_for_byte(path):
    offsets = OFFSETS.copy()
    offsets[0, 0, 0] = -0.0
    text = ffd(offsets, SPACING, (1.0, 0.0, 0.0, 1.0, 178.910522, 172.385544, -130.221436), one="0 or so")
    deformer = read(path, text)
    copy = path.with_name("copy.ffd")
    report = pl.write_transform(deformer, copy)
    assert copy.read_bytes() == path.read_bytes()
    assert b"-0.000000" in copy.read_bytes()
    assert report.losses == ()
    edited = deformer.moved(deformer.controls + np.eye(1, 60)[0].reshape(3, 4, 5, 1))
    pl.write_transform(edited, copy)
    before, after = path.read_bytes().split(), copy.read_bytes().split()
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 3  # one point moved, one point written anew


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10_000), st.sampled_from([1.0, -1.0]), st.booleans())
def test_a_new_lattice_comes_back_within_the_error_reported(tmp_path_factory, seed, hand, half_turn):
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4) * [0 if half_turn else 1, 1, 1, 1]
    quaternion /= np.linalg.norm(quaternion)
    assume(half_turn or abs(quaternion[0]) > 2e-3)  # so near a half turn, six decimals of b, c, d do not tell a
    axes = nib.quaternions.quat2mat(quaternion) * [1, 1, hand]
    deformer = pl.BSplineFFD(
        displacements=rng.normal(size=(3, 4, 5, 3)), origin=rng.normal(size=3), spacing=rng.uniform(5, 20, 3), axes=axes
    )
    path = tmp_path_factory.mktemp("new") / "new.FFD"
    report = pl.write_transform(deformer, path)
    again = pl.read_transform(path)
    assert np.abs(again.rest - deformer.rest).max() < 1e-3  # a half turn costs up to half the digits
    assert np.abs(again.displacements - deformer.displacements).max() < 1e-5
    assert any("pull-back" in note for note in report.notes)
    assert any("edge" in note for note in report.notes)


def test_the_affine_part_goes_to_a_file_beside(path):
    matrix = np.eye(4)
    matrix[:3] += np.round(0.1 * RNG.normal(size=(3, 4)), 6)
    deformer = pl.BSplineFFD(displacements=OFFSETS, origin=(0, 0, 0), spacing=SPACING, axes=np.eye(3), affine=matrix)
    report = pl.write_transform(deformer, path)
    assert any("lattice.AFF" in note for note in report.notes)
    lattice, affine = pl.read_transform(path), pl.read_transform(path.with_suffix(".AFF"))
    assert np.allclose(affine(POINTS) + lattice(POINTS) - POINTS, deformer(POINTS), atol=1e-9)


def test_rounding_that_matters_is_a_loss(path):
    tiny = pl.BSplineFFD(displacements=1e-4 * OFFSETS, origin=(0, 0, 0), spacing=(1e-3,) * 3, axes=np.eye(3))
    assert pl.write_transform(tiny, path).losses
    path.unlink()
    with pytest.raises(pl.PliantError, match="would lose"):
        pl.write_transform(tiny, path, strict=True)
    nothing = pl.BSplineFFD(displacements=OFFSETS, origin=(0, 0, 0), spacing=(1e-8,) * 3, axes=np.eye(3))
    with pytest.raises(pl.PliantError, match="six decimals"):
        pl.write_transform(nothing, path)
    assert not path.exists()
