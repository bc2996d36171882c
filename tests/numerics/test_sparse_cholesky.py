"""The sparse factor against dense linear algebra: its pattern, its pivots, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import SingularSystem
from pliant.numerics.sparse import fill_reducing
from pliant.numerics.sparse.elimination import Elimination
from pliant.numerics.sparse.matching import halve
from pliant.numerics.sparse.sparse_cholesky import Cholesky


def grid(along: int, across: int, power: int = 1) -> sp.csc_array:
    """A power of the Laplacian of a grid, made definite."""
    line = [sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)) for n in (along, across)]
    plane = sp.csc_array(sp.kron(line[0], sp.eye_array(across)) + sp.kron(sp.eye_array(along), line[1]))
    result = plane
    for _ in range(power - 1):
        result = sp.csc_array(result @ plane)
    return result


def sparse(size: int, seed: int) -> sp.csc_array:
    random = np.random.default_rng(seed)
    part = sp.random_array((size, size), density=min(1.0, 2 / size), rng=random)
    return sp.csc_array(part @ part.T + sp.eye_array(size))


@settings(max_examples=40, deadline=None)
@given(size=st.integers(1, 120), seed=st.integers(0, 10**6))
def test_the_shape_holds_every_entry_of_the_factor(size, seed):
    matrix = sparse(size, seed)
    shape = Elimination(matrix, np.random.default_rng(seed).permutation(size))
    factor = np.linalg.cholesky(matrix.toarray()[np.ix_(shape.order, shape.order)])
    held = np.zeros((size, size), bool)
    for s in range(len(shape.width)):
        columns = slice(shape.first[s], shape.first[s + 1])
        held[columns, columns] = True
        rows = shape.rows[shape.row_starts[s] : shape.row_starts[s + 1]]
        assert (np.diff(rows) > 0).all()
        assert (rows >= shape.first[s + 1]).all()
        held[rows, columns] = True
    assert not np.abs(factor)[~held].any()


@pytest.mark.parametrize(
    "matrix",
    [grid(90, 70, 2), grid(40, 30, 3), grid(3000, 1), sp.csc_array(np.ones((300, 300)) + 300 * np.eye(300)),
     sp.csc_array(sp.block_diag([grid(20, 20), grid(30, 9, 2), sp.eye_array(40)]))],
    ids=["plane", "thick", "line", "dense", "apart"],
)  # fmt: skip
def test_it_solves_to_working_precision(matrix):
    right = np.random.default_rng(0).normal(size=(matrix.shape[0], 4))
    for factor in (Cholesky(matrix), Cholesky(3 * matrix).refactored(matrix)):
        solution = factor.solve(right)
        assert (
            np.abs(matrix @ solution - right).max() < 1e-15 * np.abs(matrix).sum(axis=0).max() * np.abs(solution).max()
        )


def test_another_pattern_is_factored_anew():
    one, other = grid(30, 20), grid(30, 20, 2)
    right = np.random.default_rng(0).normal(size=600)
    again = Cholesky(one).refactored(other)
    assert np.abs(again.solve(right) - np.linalg.solve(other.toarray(), right)).max() < 1e-6
    assert again.refactored(other).elimination is again.elimination


@settings(max_examples=20, deadline=None)
@given(size=st.integers(2, 500), seed=st.integers(0, 10**6))
def test_an_entry_without_its_mirror_image_is_rounding(size, seed):
    matrix = sparse(size, seed)
    row, column = np.random.default_rng(seed).integers(0, size, 2)
    uneven = sp.csc_array(matrix + sp.csc_array(([1e-18], ([row], [column])), shape=matrix.shape))
    right = np.ones(size)
    assert np.abs(matrix @ Cholesky(uneven).solve(right) - right).max() < 1e-10


@pytest.mark.parametrize("bad", [0, 77, 599])
def test_the_unknown_that_spoils_it_is_named(bad):
    apart = sp.csc_array(grid(30, 20) + 0.0 * sp.eye_array(600))
    keep = sp.diags_array((np.arange(600) != bad).astype(float))
    with pytest.raises(SingularSystem, match=rf"600 unknowns is not positive definite at unknown {bad}:"):
        Cholesky(sp.csc_array(keep @ apart @ keep))
    with pytest.raises(SingularSystem, match="not finite"):
        Cholesky(sp.csc_array(apart + sp.csc_array(([np.nan], ([bad], [bad])), shape=(600, 600))))


@settings(max_examples=30, deadline=None)
@given(size=st.integers(1, 200), seed=st.integers(0, 10**6))
def test_a_halved_graph_keeps_neighbours(size, seed):
    matrix = sparse(size, seed)
    members, starts, neighbors = halve(matrix.indptr.astype(np.int64), matrix.indices, matrix.data)
    pair = np.full(size, -1)
    for c, both in enumerate(members):
        pair[both[both >= 0]] = c
    assert np.array_equal(np.sort(members[members >= 0]), np.arange(size))
    rows, columns = matrix.nonzero()
    expected = {(a, b) for a, b in zip(pair[rows], pair[columns], strict=True) if a != b}
    found = [(c, n) for c in range(len(members)) for n in neighbors[starts[c] : starts[c + 1]]]
    assert len(found) == len(expected)
    assert set(found) == expected
    together = members[members[:, 1] >= 0]
    assert (matrix.toarray()[together[:, 0], together[:, 1]] != 0).all()


def test_both_orders_keep_the_fill_low():
    matrix = grid(60, 60, 2)
    natural = Elimination(matrix, np.arange(3600)).block_starts[-1]
    for order in (fill_reducing.nested_dissection(matrix), fill_reducing.minimum_degree(matrix)):
        assert np.array_equal(np.sort(order), np.arange(3600))
        assert Elimination(matrix, order).block_starts[-1] < 0.8 * natural
