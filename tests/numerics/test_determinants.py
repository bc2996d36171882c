"""det J in Bernstein form: coefficients, bounds of rounding, and exact arithmetic."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.numerics.lattices.bases import bernstein
from pliant.numerics.lattices.crossings import CUBIC_FROM_SAMPLES, positive_until, restriction
from pliant.numerics.lattices.determinants import Determinants, halve, halving_error
from pliant.numerics.lattices.polynomial_cells import determinant, dot, inverse, rational
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD

BOX = np.array([[0.3, -1.0, 2.0], [1.3, 1.0, 2.5]])
AFFINE = np.array([[1.1, 0.2, 0.0, 3.0], [-0.1, 0.9, 0.3, 0.0], [0.0, 0.1, 1.2, -1.0], [0, 0, 0, 1.0]])
TURN = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]])  # left-handed: det F is negative


def spline(seed=0, shape=(4, 5, 4), strength=0.3, **fields):
    rng = np.random.default_rng(seed)
    spacing = rng.uniform(0.3, 2.0, 3)
    values = strength * spacing * rng.normal(size=(*shape, 3))
    return BSplineFFD(displacements=values, origin=rng.normal(size=3), spacing=spacing, **fields)


def bezier(seed=0, strength=0.1, **fields):
    rest = BezierFFD.around(BOX, **fields)
    return rest.moved(rest.rest + strength * np.random.default_rng(seed).normal(size=rest.rest.shape))


MAPS = {
    "clamped": spline(),
    "zero edge": spline(edge="zero"),
    "jumping edge": spline(edge="identity"),
    "affine and left-handed": spline(axes=TURN, affine=AFFINE),
    "planar": spline(shape=(5, 4, 1)),
    "hyperpatch": bezier(),
    "degrees 1, 2, 4": bezier(shape=(2, 3, 5)),
    "degree 0": bezier(shape=(1, 3, 4)),
    "degree 6": bezier(shape=(7, 7, 7)),
    "patches": bezier(patches=(2, 1, 3)),
}


def from_coefficients(coefficients, t):
    x, y, z = (bernstein(size - 1, np.array([t[a]]))[0] for a, size in enumerate(coefficients.shape))
    return np.einsum("ijk,i,j,k->", coefficients, x, y, z)


@pytest.mark.parametrize("name", MAPS)
def test_the_polynomial_is_the_determinant_of_the_jacobian(name):
    deformer, rng = MAPS[name], np.random.default_rng(1)
    cells = deformer.polynomial_cells()
    chosen = rng.integers(0, np.prod(cells.counts), 6)
    coefficients, error = Determinants(cells).coefficients(chosen)
    for cell, polynomial, bound in zip(chosen, coefficients, error, strict=True):
        t = rng.uniform(0.05, 0.95, 3)
        expected = np.linalg.det(deformer.jacobian(cells.position(cell, t)[None]))[0]
        assert from_coefficients(polynomial, t) == pytest.approx(expected, rel=1e-11, abs=1e-12)
        assert bound < 1e-10
        assert float(cells.exact_determinant(cell, t)) == pytest.approx(expected, rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("name", MAPS)
def test_what_a_corner_s_coefficient_misses_of_the_exact_value_is_within_the_bound(name):
    cells = MAPS[name].polynomial_cells()
    chosen = np.arange(min(20, np.prod(cells.counts)))
    coefficients, error = Determinants(cells).coefficients(chosen)
    for cell, polynomial, bound in zip(chosen, coefficients, error, strict=True):
        for corner in ((0, 0, 0), (1, 0, 1), (1, 1, 1)):
            value = polynomial[tuple(-i for i in corner)]
            assert abs(Fraction(float(value)) - cells.exact_determinant(cell, corner)) <= Fraction(float(bound))


@pytest.mark.parametrize("name", MAPS)
def test_rough_bounds_hold_the_coefficients_bounds(name):
    cells = MAPS[name].polynomial_cells()
    chosen = np.arange(np.prod(cells.counts))
    polynomials = Determinants(cells)
    low, high = polynomials.ranges(chosen)
    values, error = polynomials.coefficients(chosen)
    corners = values[:, [0, -1]][:, :, [0, -1]][:, :, :, [0, -1]].reshape(len(chosen), 8)
    assert (low <= corners.min(axis=1) + error).all()
    assert (high >= corners.max(axis=1) - error).all()
    along, _ = polynomials.ranges(chosen, path=1.0)
    assert (along <= low + 1e-12 * np.abs(low)).all()  # a path passes its end


def exact_coefficients(cells, cell):
    """Bernstein coefficients of det J in a cell of a multilinear map, in fractions: by products, written out."""
    step = [rational(np.diff(cells.values, axis=axis).reshape(-1, 3)) for axis in range(3)]
    frame, linear = rational(cells.frame[:, :3]), rational(cells.linear)
    back = inverse(frame)
    constant = [[sum(linear[c][j] * back[j][a] for j in range(3)) for a in range(3)] for c in range(3)]

    def column(axis, place):
        others = [place[b] for b in range(3) if b != axis]
        slope = step[axis][2 * others[0] + others[1]]
        return [constant[c][axis] + slope[c] for c in range(3)]

    first, second, third = ([p for p in np.ndindex(2, 2, 2) if p[axis] == 0] for axis in range(3))
    total = {}
    for a, b, c in product(first, second, third):
        place = tuple(map(sum, zip(a, b, c, strict=True)))
        columns = column(0, a), column(1, b), column(2, c)
        value = determinant([list(row) for row in zip(*columns, strict=True)])
        total[place] = total.get(place, Fraction(0)) + value
    size = determinant(frame)
    return {p: size * value / (comb(2, p[0]) * comb(2, p[1]) * comb(2, p[2])) for p, value in total.items()}


@given(seed=st.integers(0, 100_000), size=st.sampled_from([1e-9, 1e-3, 1.0, 1e6]))
@settings(deadline=None, max_examples=8)
def test_coefficients_of_a_multilinear_patch_are_the_exact_ones_within_the_bound(seed, size):
    deformer = bezier(seed, strength=size, shape=(2, 2, 2))
    cells = deformer.polynomial_cells()
    (found,), (bound,) = Determinants(cells).coefficients(np.array([0]))
    exact = exact_coefficients(cells, 0)
    assert found.shape == (3, 3, 3)
    for place, value in exact.items():
        assert abs(Fraction(float(found[place])) - value) <= Fraction(float(bound))


@given(seed=st.integers(0, 100_000), axis=st.integers(1, 3))
@settings(deadline=None, max_examples=20)
def test_halves_are_the_same_polynomial(seed, axis):
    rng = np.random.default_rng(seed)
    whole = rng.normal(size=(2, 4, 3, 6))
    lower, upper = halve(whole, axis)
    t = rng.random(3)
    for half, start in ((lower, 0.0), (upper, 0.5)):
        at = t.copy()
        at[axis - 1] = start + t[axis - 1] / 2
        assert from_coefficients(half[1], t) == pytest.approx(from_coefficients(whole[1], at), rel=1e-12, abs=1e-13)
    assert (halving_error(whole, 5) < 1e-14).all()
    assert lower.max() <= whole.max()
    assert upper.min() >= whole.min()


@given(seed=st.integers(0, 100_000))
@settings(deadline=None, max_examples=50)
def test_a_cubic_is_positive_as_far_as_it_is_said_to_be_and_not_much_farther(seed):
    cubic = np.random.default_rng(seed).normal(size=4) + [1.5, 0.3, 0.3, 0]
    reached = float(positive_until(cubic[None])[0])
    t = np.linspace(0, 1, 20_001)
    values = bernstein(3, t) @ cubic
    assert (values[t < reached] > 0).all()
    if reached < 1 and cubic[0] > 0:
        beyond = (t >= reached - 1e-9) & (t < reached + 1e-3)
        assert values[beyond].min() < 1e-3


def test_a_cubic_from_samples_and_on_a_piece():
    cubic = np.array([1.0, -2.0, 0.5, 3.0])
    samples = bernstein(3, np.array([0, 1 / 3, 2 / 3, 1])) @ cubic
    assert np.allclose(CUBIC_FROM_SAMPLES @ samples, cubic, atol=1e-13)
    piece = restriction(np.array([0.2]), np.array([0.7]))[0] @ cubic
    t = np.linspace(0, 1, 7)
    assert np.allclose(bernstein(3, t) @ piece, bernstein(3, 0.2 + 0.5 * t) @ cubic)


def test_fractions():
    matrix = rational(np.array([[2.0, 1, 0], [0, 3, 1], [1, 0, 1]]))
    columns = list(zip(*inverse(matrix), strict=True))
    assert [[dot(row, column) for column in columns] for row in matrix] == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert determinant(matrix) == 7
