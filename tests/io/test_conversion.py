"""Every transform format into every other: exactly where the bases agree, with an honest residual where not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter, LossRefused, UnsupportedFormat
from pliant.io.conversion import convert_transform, direction_note, inverted
from pliant.space.clamped_ffd import ClampedFFD
from pliant.space.compose import compose
from pliant.space.refit import refit
from pliant.space.region import Region, region_of

pytestmark = pytest.mark.filterwarnings("ignore::pliant.errors.PliantWarning")

AXES = pl.Affine.rotation((1, -2, 3), 0.6).linear
SPACING = np.array([10.0, 12, 8])


def lattice(size=0.5, edge="clamp"):
    values = np.random.default_rng(0).normal(size=(7, 6, 8, 3)) * size
    return pl.BSplineFFD(
        displacements=values, origin=(-30, 20, -10), spacing=SPACING, axes=AXES, edge=edge, direction="pull-back"
    )


def inside(ffd, first=1.0, count=500):
    q = np.random.default_rng(1).uniform(first, np.array(ffd.rest.shape[:3]) - 1 - first, (count, 3))
    return ffd.origin + (q * ffd.spacing) @ ffd.axes.T


AFFINE = ["a.AFF", "a.tfm", "a.h5", "a.0.txt", "affine.txt", "a.dof"]
B_SPLINES = ["a.FFD", "a.tfm", "a.h5", "a.0.txt", "a.nii.gz", "a.dof.gz"]


@pytest.mark.parametrize(("one", "two"), list(itertools.permutations(B_SPLINES, 2)))
def test_b_splines_are_exact_between_all_formats_that_have_them(tmp_path, one, two):
    """To a millionth of the spacing at random points, by way of any other format."""
    ffd = lattice()
    first, second = tmp_path / "first" / one, tmp_path / "second" / two
    pl.write_transform(ffd, first)
    convert_transform(pl.read_transform(first), second)
    again = pl.read_transform(second)
    points = inside(ffd)
    assert isinstance(again, pl.BSplineFFD)
    assert np.abs(again(points) - ffd(points)).max() <= 1e-6 * SPACING.min()


@pytest.mark.parametrize(
    ("one", "two"), list(itertools.permutations(["a.AFF", "a.tfm", "a.h5", "a.0.txt", "affine.txt", "a.dof"], 2))
)
def test_affine_maps_between_all_formats_that_have_them(tmp_path, one, two):
    matrix = np.eye(4)
    matrix[:3] += np.round(np.random.default_rng(2).normal(size=(3, 4)) * 0.1, 6)
    first, second = tmp_path / "first" / one, tmp_path / "second" / two
    pl.write_transform(pl.Affine(matrix, "pull-back"), first)
    convert_transform(pl.read_transform(first), second, strict=True)
    assert np.abs(pl.read_transform(second).matrix - matrix).max() < 1e-6


@pytest.mark.parametrize(("one", "two"), list(itertools.permutations(["a.tfm", "a.h5", "a.nii.gz", "a.mha"], 2)))
def test_displacement_grids_between_all_formats_that_have_them(tmp_path, one, two):
    grid = pl.DisplacementGrid(
        displacements=np.random.default_rng(3).normal(size=(6, 5, 7, 3)), origin=(1, 2, 3), spacing=(2, 2, 3), rim=0.5
    )
    first, second = tmp_path / "first" / one, tmp_path / "second" / two
    pl.write_transform(grid, first)
    convert_transform(pl.read_transform(first), second, strict=True)
    points = inside(grid, -0.4)
    assert np.abs(pl.read_transform(second)(points) - grid(points)).max() < 2e-6


@pytest.mark.parametrize("name", ["a.prm", "a.mha", "a.AFF", "affine.txt"])
def test_a_refit_says_how_far_it_is_off(tmp_path, name):
    ffd, path = lattice(), tmp_path / name
    report = convert_transform(ffd, path)
    told = float(report.losses[0].split("off by ")[1].split(" ")[0])
    region, _ = region_of(ffd)
    points = region.points(np.random.default_rng(9).uniform(0.001, 0.999, (20_000, 3)))
    off = np.linalg.norm(pl.read_transform(path)(points) - ffd(points), axis=1).max()
    assert 0.7 * told < off < 1.3 * told + 1e-4
    with pytest.raises(LossRefused, match="off by"):
        convert_transform(ffd, tmp_path / f"strict-{name}", strict=True)
    assert not (tmp_path / f"strict-{name}").exists()


def test_finer_refits_converge(tmp_path):
    ffd, off = lattice(), []
    for count in (6, 12, 24):
        report = convert_transform(ffd, tmp_path / "a.xyz", shape=(count,) * 3)
        assert "the box at rest" in report.losses[1]
        off.append(float(report.losses[0].split("off by ")[1].split(" ")[0]))
    assert off[0] > 4 * off[1] > 16 * off[2]


def test_polynomials_are_refitted_exactly(tmp_path):
    """A tricubic hyperpatch is in the space of every cubic basis on its box."""
    box = pl.BezierFFD.around(np.array([[0, 0, 0], [10, 20, 30.0]]), shape=(4, 4, 4))
    bent = box.moved(box.rest + np.random.default_rng(0).normal(size=box.rest.shape))
    points = np.random.default_rng(1).uniform(0.01, 0.99, (300, 3)) * [10, 20, 30]
    for name in ("a.dof", "a.0.txt"):
        report = convert_transform(bent, tmp_path / name, strict=True)
        assert any("refitted" in note for note in report.notes)
        assert np.abs(pl.read_transform(tmp_path / name)(points) - bent(points)).max() < 1e-10


@pytest.mark.parametrize("kind", ["bspline", "bernstein", "clamped", "grid", "affine"])
def test_what_is_of_the_kind_is_found_again(kind):
    box = np.array([[0, 0, 0], [10, 20, 30.0]])
    random = np.random.default_rng(0)
    clamped = ClampedFFD.around(box, shape=(7, 5, 6))
    bezier = pl.BezierFFD.around(box, shape=(6, 3, 5))
    spline = pl.BSplineFFD(
        displacements=random.normal(size=(7, 5, 6, 3)), origin=[-2.5, -10, -10], spacing=[2.5, 10, 10]
    )
    made = {
        "bspline": spline,
        "bernstein": bezier.moved(bezier.rest + random.normal(size=bezier.rest.shape)),
        "clamped": clamped.moved(clamped.rest + random.normal(size=clamped.rest.shape)),
        "grid": pl.to_grid(spline, box, shape=(7, 5, 6)),
        "affine": pl.Affine.rotation("x", 0.4),
    }[kind]
    found = refit(made, kind, Region.around(box), made.rest.shape[:3] if kind != "affine" else (2, 2, 2))
    assert found.largest < 1e-10


@pytest.mark.parametrize("name", ["a.tfm", "a.dof", "a.FFD", "a.nii.gz"])
def test_the_inverse(tmp_path, name):
    ffd, path = lattice(0.2), tmp_path / name
    report = convert_transform(inverted(ffd), path, shape=(40, 40, 40))
    told = float(report.losses[0].split("off by ")[1].split(" ")[0])
    points = inside(ffd, 1.5)
    back = pl.read_transform(path)(ffd(points))
    assert np.linalg.norm(back - points, axis=1).max() < 1.5 * told + 1e-4
    assert told < 0.05


def test_the_inverse_of_affine_maps_and_compositions_is_exact(tmp_path):
    turn = pl.Affine.rotation("x", 0.4, (1, 2, 3))
    chain = inverted(compose(turn, pl.Affine.scaling((1, 2, 3))))
    points = np.random.default_rng(0).normal(size=(20, 3))
    convert_transform(chain, tmp_path / "a.tfm", strict=True)
    expected = turn.inverse(points / [1, 2, 3])
    assert np.abs(pl.read_transform(tmp_path / "a.tfm")(points) - expected).max() < 1e-12


def test_maps_that_jump_at_their_border_are_continued_before_they_are_inverted():
    ffd = lattice(0.5, "identity")
    backward, points = inverted(ffd), inside(ffd, 1.01)
    assert np.abs(backward(ffd(points)) - points).max() < 1e-7


def test_a_map_without_a_box_needs_one(tmp_path, box_mesh):
    with pytest.raises(InvalidParameter, match="--around"):
        convert_transform(pl.Affine.rotation("x", 0.4), tmp_path / "a.prm")
    convert_transform(pl.Affine.rotation("x", 0.4), tmp_path / "a.prm", around=box_mesh, strict=True)
    moved = pl.read_transform(tmp_path / "a.prm")(box_mesh.points * 0.999 + 0.0005)
    assert np.abs(moved - pl.Affine.rotation("x", 0.4)(box_mesh.points * 0.999 + 0.0005)).max() < 1e-12
    with pytest.raises(UnsupportedFormat):
        convert_transform(pl.Affine(), tmp_path / "a.docx")


def test_the_other_direction_is_told():
    assert "pull-back" in direction_note(lattice(), "a.prm")[0]
    assert not direction_note(lattice(), "a.tfm")
