"""Proofs against folds: never contradicted by samples, by exact arithmetic, or by the laws of composition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pliant as pl
from pliant.errors import InvalidParameter, NonFiniteResult, NotDifferentiable

BOX = np.array([[0.0, 0, 0], [2.0, 3.0, 1.0]])
RANDOM = np.random.default_rng(0)


def wild(kind, seed, strength):
    """A lattice whose control points leave their places by about a strength times their distance."""
    rest = {
        "clamp": lambda: pl.BSplineFFD.around(BOX, shape=(4, 5, 4)),
        "zero": lambda: pl.BSplineFFD.around(BOX, shape=(3, 4, 4), edge="zero"),
        "identity": lambda: pl.BSplineFFD.around(BOX, shape=(5, 5, 6), edge="identity"),
        "planar": lambda: pl.BSplineFFD.around(BOX, shape=(5, 5, 1)),
        "patch": lambda: pl.BezierFFD.around(BOX),
        "degrees": lambda: pl.BezierFFD.around(BOX, shape=(3, 5, 2)),
        "patches": lambda: pl.BezierFFD.around(BOX, patches=(2, 1, 1)),
    }[kind]()
    steps = (BOX[1] - BOX[0]) / np.maximum(np.array(rest.shape) - 1, 1)
    return rest.moved(rest.rest + strength * steps * np.random.default_rng(seed).normal(size=rest.rest.shape))


def samples(deformer, count, seed=0):
    """Points in the box of a lattice, and for B-splines around it, as far as the support reaches."""
    reach = 1.0 if isinstance(deformer, pl.BSplineFFD) else 0.0
    room = reach * (BOX[1] - BOX[0])
    return np.random.default_rng(seed).uniform(BOX[0] - room, BOX[1] + room, (count, 3))


@given(
    kind=st.sampled_from(["clamp", "zero", "identity", "planar", "patch", "degrees", "patches"]),
    seed=st.integers(0, 100_000),
    strength=st.sampled_from([0.05, 0.2, 0.4, 0.8]),
)
@settings(deadline=None, max_examples=25)
def test_samples_never_contradict(kind, seed, strength):
    deformer = wild(kind, seed, strength)
    proof = pl.certify(deformer)
    ratio = pl.volume_ratio(deformer, samples(deformer, 20_000, seed))
    assert proof.lower <= proof.least <= proof.greatest <= proof.upper
    assert proof.lower - 1e-12 <= ratio.min()
    assert ratio.max() <= proof.upper + 1e-12
    assert proof.status in {"fold-free", "folds"}
    assert pl.volume_ratio(deformer, proof.point[None])[0] == pytest.approx(proof.least, rel=1e-6, abs=1e-7)
    if proof.status == "fold-free":
        assert proof.lower > 0
    else:
        assert proof.least <= 0


def test_a_hundred_thousand_samples_and_tight_bounds():
    deformer = wild("clamp", 3, 0.25)
    proof = pl.certify(deformer, tolerance=1e-3)
    ratio = pl.volume_ratio(deformer, samples(deformer, 100_000))
    assert proof.status == "fold-free"
    assert proof.lower <= ratio.min() <= proof.lower + 0.1
    assert proof.lower == pytest.approx(proof.least, rel=2e-3)
    assert proof.upper == pytest.approx(proof.greatest, rel=2e-3)
    assert proof.injective
    far, close = proof.volume_error
    assert far <= np.abs(ratio - 1).max() + 0.05
    assert np.abs(ratio - 1).max() <= close


def test_coefficients_prove_what_they_need_not_reach():
    """Without a halving bounds are loose but true; halving closes the gap."""
    deformer = wild("patch", 4, 0.3)
    loose, tight = pl.certify(deformer, budget=0), pl.certify(deformer, tolerance=1e-4)
    assert loose.subdivisions == 0
    assert tight.subdivisions > 0
    assert loose.lower < tight.lower <= tight.least
    assert tight.lower == pytest.approx(tight.least, rel=1e-3)


def test_beyond_the_lattice_a_zero_edge_folds():
    """The last control points pull their neighbourhood outside the box, where nothing else would look."""
    rest = pl.BSplineFFD.around(BOX, shape=(4, 4, 4), edge="zero")
    moved = rest.rest + [-2.5 * rest.spacing[0], 0, 0]
    proof = pl.certify(rest.moved(moved))
    assert proof.status == "folds"
    assert not proof.injective
    outside = (proof.point < BOX[0]) | (proof.point > BOX[1])
    assert outside.any()
    inside = np.random.default_rng(0).uniform(BOX[0] + 1e-9, BOX[1], (2000, 3))
    assert proof.least < pl.volume_ratio(rest.moved(moved), inside).min()


@given(seed=st.integers(0, 100_000), kind=st.sampled_from(["clamp", "patch", "degrees"]))
@settings(deadline=None, max_examples=8)
def test_a_flattened_map_is_never_called_fold_free(seed, kind):
    """det J = 0 everywhere but for the rounding of the control points, either way."""
    deformer = wild(kind, seed, 0.2)
    rng = np.random.default_rng(seed)
    plane = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    flat = deformer.controls @ plane @ np.diag([1.0, 1.0, 0.0]) @ plane.T
    proof = pl.certify(deformer.moved(flat), budget=200)
    assert proof.status != "fold-free" or proof.lower < 1e-11
    assert proof.lower < 1e-11
    if proof.status == "fold-free":  # then exact arithmetic agrees at every corner of every cell
        cells = deformer.moved(flat).polynomial_cells()
        assert all(cells.exact_determinant(cell, (0, 0, 0)) > 0 for cell in range(int(np.prod(cells.counts))))


def test_a_map_flattened_without_rounding_folds_exactly():
    rest = pl.BezierFFD.around(BOX, shape=(2, 2, 2))
    flat = rest.rest.copy()
    flat[..., 2] = 0.5
    proof = pl.certify(rest.moved(flat))
    assert proof.status == "folds"
    assert proof.least == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("push", [1e-15, 1e-12, -1e-12, 1e-9])
def test_close_to_a_fold_the_answer_is_right_or_none(push):
    """A trilinear patch whose least det J is the given number, up to rounding: exact arithmetic judges."""
    rest = pl.BezierFFD.around(np.array([[0.0, 0, 0], [1, 1, 1]]), shape=(2, 2, 2))
    moved = rest.rest.copy()
    moved[1, 0, 0, 0] = push  # the edge along x from the origin is as short as that
    deformer = rest.moved(moved)
    exact = deformer.polynomial_cells().exact_determinant(0, (0, 0, 0))
    proof = pl.certify(deformer)
    assert {"fold-free": exact > 0, "folds": exact <= 0, "undecided": abs(exact) < 1e-13}[proof.status]
    assert proof.lower <= exact


def test_a_huge_translation_hides_nothing():
    deformer = wild("clamp", 5, 0.3)
    far = replace(deformer, displacements=deformer.displacements + 1e6)
    near, there = pl.certify(deformer), pl.certify(far)
    assert near.status == there.status
    assert there.least == pytest.approx(near.least, abs=1e-7)


def test_the_scale_of_the_world_does_not_matter():
    deformer = wild("zero", 6, 0.3)
    proof = pl.certify(deformer)
    for unit in (1e-9, 1e9):
        other = replace(
            deformer,
            displacements=unit * deformer.displacements,
            origin=unit * deformer.origin,
            spacing=unit * deformer.spacing,
        )
        assert pl.certify(other).lower == pytest.approx(proof.lower, rel=1e-6)


def test_injective_where_the_map_is_continuous():
    rim = pl.BezierFFD.around(BOX, shape=(6, 6, 6))
    noise = 0.05 * np.random.default_rng(1).normal(size=rim.rest.shape)
    assert pl.certify(rim.moved(rim.rest + noise * rim.free(0)[..., None])).injective is True
    assert pl.certify(rim.moved(rim.rest + noise)).injective is None  # it jumps at the rim
    assert pl.certify(replace(rim, outside="extend")).injective is None  # nothing is known outside
    assert pl.certify(wild("identity", 0, 0.1)).injective is None
    inner = pl.BSplineFFD.around(BOX, shape=(8, 8, 8), edge="identity")
    step = np.zeros((8, 8, 8, 1))
    step[3:5, 3:5, 3:5] = 0.05
    assert pl.certify(inner.moved(inner.rest + step)).injective is True
    assert pl.certify(wild("clamp", 1, 1.0)).injective is False


def test_injective_maps_keep_distinct_points_distinct():
    deformer = wild("zero", 8, 0.25)
    assert pl.certify(deformer).injective
    points = samples(deformer, 3000)
    assert np.allclose(deformer.inverse(deformer(points)), points, atol=1e-7)


def test_affine_parts_count_everywhere():
    deformer = wild("zero", 2, 0.1)
    affine = np.diag([2.0, 1.0, 0.5, 1.0])
    proof = pl.certify(replace(deformer, affine=affine))
    assert proof.lower <= 1.0 <= proof.upper
    mirrored = pl.certify(replace(deformer, affine=np.diag([-1.0, 1, 1, 1])))
    assert mirrored.status == "folds"
    assert mirrored.lower <= -1 <= mirrored.upper


def test_maps_with_constant_determinants_are_exact():
    assert pl.certify(pl.Affine.scaling((2, 3, 0.5))).lower == 3.0
    assert pl.certify(pl.Affine.scaling((1, 1, 0))).status == "folds"
    mirror = pl.certify(pl.Affine.scaling((-1, 1, 1)))
    assert (mirror.status, mirror.injective) == ("folds", True)
    for kept in (pl.Twist(axis="z", angle=2.0), pl.Squash(axis="x", factor=1.5)):
        proof = pl.certify(kept)
        assert (proof.status, proof.lower, proof.upper, proof.injective) == ("fold-free", 1.0, 1.0, True)
        assert proof.volume_error == (0.0, 0.0)
        assert np.allclose(pl.volume_ratio(kept, RANDOM.normal(size=(50, 3))), 1)


def test_placed_and_inverted_maps():
    deformer = wild("clamp", 9, 0.15)
    proof, frame = pl.certify(deformer), pl.Affine.rotation([1, 2, 3], 0.5) @ pl.Affine.scaling(2.0)
    placed = pl.certify(pl.place(deformer, frame))
    assert (placed.lower, placed.upper) == (proof.lower, proof.upper)
    assert pl.volume_ratio(pl.place(deformer, frame), placed.point[None])[0] == pytest.approx(proof.least)
    inverse = pl.certify(pl.Inverse(deformer))
    assert inverse.status == "fold-free"
    assert inverse.lower * proof.upper == pytest.approx(1)
    assert pl.volume_ratio(pl.Inverse(deformer), inverse.point[None])[0] == pytest.approx(1 / proof.least, rel=1e-6)


def test_compositions_by_the_product_of_bounds():
    first, second = wild("clamp", 9, 0.1), wild("zero", 10, 0.1)
    both = pl.compose(first, pl.Twist(axis="z", angle=1.0), second)
    proof = pl.certify(both)
    assert (proof.status, proof.method, proof.injective) == ("fold-free", "bounds", True)
    ratio = pl.volume_ratio(both, samples(first, 5000))
    assert proof.lower <= ratio.min()
    assert ratio.max() <= proof.upper
    folding = pl.certify(pl.compose(first, wild("clamp", 3, 1.5)), bounds=tuple(BOX))
    assert (folding.status, folding.method) == ("folds", "sampled")
    assert pl.volume_ratio(pl.compose(first, wild("clamp", 3, 1.5)), folding.point[None])[0] <= 0


def test_what_is_only_sampled_is_never_proved():
    bend = pl.Bend(axis="y", angle=0.5, bounds=(0, 1))
    proof = pl.certify(bend, bounds=tuple(BOX / 10))
    assert (proof.status, proof.method, proof.lower) == ("undecided", "sampled", -np.inf)
    assert pl.certify(bend).least is None  # nobody said where to look
    assert pl.certify(bend, bounds=((-1, -1, -9), (1, 1, 9))).status == "folds"


def test_progress_is_told_and_what_it_raises_ends_the_search():
    told, wild_one = [], wild("clamp", 3, 0.4)
    proof = pl.certify(wild_one, budget=3000, tolerance=1e-6, progress=told.append)
    assert len(told) > 1
    assert told == sorted(told)
    assert told[-1] == pytest.approx(proof.subdivisions / 3000)

    def enough(part):
        raise KeyboardInterrupt(part)

    with pytest.raises(KeyboardInterrupt):
        pl.certify(wild_one, budget=3000, tolerance=1e-6, progress=enough)


def test_bad_input():
    lattice = pl.BSplineFFD.around(BOX)
    with pytest.raises(InvalidParameter, match="budget"):
        pl.certify(lattice, budget=-1)
    with pytest.raises(InvalidParameter, match="tolerance"):
        pl.certify(lattice, tolerance=0.0)
    with pytest.raises(InvalidParameter, match="bounds"):
        pl.certify(lattice, bounds=((1, 1, 1), (0, 0, 0)))
    with pytest.raises(NotDifferentiable, match="no map of R"):
        pl.certify(pl.LaplacianEdit([0, 1], [0]))
    with pytest.raises(NonFiniteResult, match="too large"):
        pl.certify(lattice.moved(lattice.rest * 1e200))


def test_it_says_what_it_found():
    text = str(pl.certify(wild("patch", 1, 0.1)))
    assert text.startswith("fold-free (coefficients): ")
    assert "<= det J <=" in text


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("outside", ["identity", "clamp"])
@given(seed=st.integers(0, 100_000), strength=st.sampled_from([0.1, 0.3, 0.8]))
@settings(deadline=None, max_examples=4)
def test_grids_of_displacements(interpolation, outside, seed, strength):
    rng = np.random.default_rng(seed)
    spacing = np.array([0.5, 1.0, 0.7])
    values = strength * spacing * rng.normal(size=(4, 5, 3, 3))
    grid = pl.DisplacementGrid(
        displacements=values, origin=(1, 2, 3), spacing=spacing, interpolation=interpolation, outside=outside
    )
    proof = pl.certify(grid)
    points = np.array([1, 2, 3]) + spacing * rng.uniform(-1, [4, 5, 3], (20_000, 3))
    ratio = pl.volume_ratio(grid, points)
    assert proof.lower - 1e-12 <= ratio.min()
    assert ratio.max() <= proof.upper + 1e-12
    assert proof.status == ("fold-free" if proof.lower > 0 else "folds")
    assert proof.injective is (proof.status == "fold-free" if outside == "clamp" else None)
    if proof.injective:
        assert np.allclose(grid.inverse(grid(points[:500])), points[:500], atol=1e-6)
