import numpy as np
import pytest

from pliant.numerics.lattices.bases import BernsteinPoints, bernstein
from pliant.numerics.lattices.cells import BERNSTEIN, BSPLINE, CellGrid, CellPoints, evaluate_once
from pliant.numerics.maps.newton import invert
from pliant.numerics.maps.normals import carry_normals, cofactor

EVERYWHERE = np.array([[-np.inf] * 3, [np.inf] * 3])


def grid(counts, stride=1, basis=BSPLINE, keep=EVERYWHERE):
    counts = np.array(counts)
    frame = np.column_stack([np.diag([2.0, 3.0, 1.0]), [0.1, -0.2, 0.3]])
    return CellGrid(frame, counts, stride, basis, np.stack([np.zeros(3), counts.astype(float)]), keep)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", [0, 7, 30_000])
def test_one_sweep_tells_when_a_point_is_not_finite(random, value, place):
    points = random.random((30_001, 3))
    points[place, 1] = value
    cells, out = grid((3, 4, 2)), np.empty_like(points)
    lattice = random.normal(size=(*cells.shape, 3))
    assert not evaluate_once(cells, points, lattice, points, out)


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 1000, 33_000, 70_001])
def test_every_chunk_remainder_agrees_with_plain_numpy(random, count):
    points = random.random((count, 3)) * 3 - 0.5
    sampled = CellPoints(grid((3, 4, 2)), points)
    lattice = random.normal(size=(*sampled.grid.shape, 3))
    out = np.empty_like(points)
    sampled.evaluate(lattice, points, out)
    index, weights = sampled.basis_values()
    expected = points + np.einsum("nk,nkc->nc", weights, lattice.reshape(-1, 3)[index])
    assert np.abs(out - expected).max(initial=0) < 1e-13
    once = np.empty_like(points)
    assert evaluate_once(sampled.grid, points, lattice, points, once)
    assert np.abs(once - expected).max(initial=0) < 1e-13
    values = random.normal(size=points.shape)
    expected = np.zeros((lattice[..., 0].size, 3))
    np.add.at(expected, index, weights[:, :, None] * values[:, None])
    assert np.abs(sampled.transpose(values).reshape(-1, 3) - expected).max(initial=0) < 1e-10


def test_points_without_a_cell_stay(random):
    points = random.random((500, 3)) * 4 - 1
    keep = np.array([[0.0] * 3, [3.0, 4, 2]])
    sampled = CellPoints(grid((3, 4, 2), keep=keep), points)
    q = points @ sampled.grid.frame[:, :3].T + sampled.grid.frame[:, 3]
    outside = ((q < keep[0]) | (q > keep[1])).any(axis=1)
    assert np.array_equal(np.sort(sampled.outside), np.flatnonzero(outside))
    out = np.empty_like(points)
    sampled.evaluate(np.ones((*sampled.grid.shape, 3)), points, out)
    assert np.array_equal(out[outside], points[outside])
    assert np.allclose(out[~outside], points[~outside] + 1, rtol=0, atol=1e-14)


@pytest.mark.parametrize("basis", [BSPLINE, BERNSTEIN])
def test_bases_sum_to_one_and_reproduce_their_coordinates(basis):
    t = np.linspace(0, 1, 11)
    values = t[:, None] ** np.arange(4) @ basis
    assert np.abs(values.sum(axis=1) - 1).max() < 1e-15
    assert (values >= -1e-16).all()
    nodes = np.array([-1, 0, 1, 2.0]) if basis is BSPLINE else np.arange(4) / 3
    assert np.abs(values @ nodes - t).max() < 1e-15


def test_bernstein_of_any_degree(random):
    t = np.linspace(-0.2, 1.2, 15)
    for degree in (0, 1, 4, 12):
        values = bernstein(degree, t)
        assert np.abs(values.sum(axis=1) - 1).max() < 1e-11
        if degree:
            assert np.abs(values @ np.linspace(0, 1, degree + 1) - t).max() < 1e-11
    points = random.random((40, 3))
    sampled = BernsteinPoints((3, 5, 2), np.eye(3, 4), np.stack([np.zeros(3), np.ones(3)]), points)
    lattice, out = random.normal(size=(3, 5, 2, 3)), np.empty_like(points)
    sampled.evaluate(lattice, points, out)
    bases = [bernstein(n - 1, points[:, a]) for a, n in enumerate((3, 5, 2))]
    assert np.abs(out - points - np.einsum("ni,nj,nk,ijkc->nc", *bases, lattice)).max() < 1e-14


def test_cofactors_carry_normals(random):
    jacobian = random.normal(size=(30, 3, 3))
    expected = np.linalg.det(jacobian)[:, None, None] * np.linalg.inv(jacobian).transpose(0, 2, 1)
    assert np.allclose(cofactor(jacobian), expected)
    edges, normals = random.normal(size=(2, 30, 3)), np.empty((30, 3))
    normals[:] = np.cross(edges[0], edges[1])
    carried = carry_normals(jacobian, normals)
    moved = [np.einsum("nij,nj->ni", jacobian, edge) for edge in edges]
    assert np.abs(np.einsum("ni,ni->n", carried, moved[0])).max() < 1e-12
    assert np.allclose(carried, np.cross(*moved) / np.linalg.norm(np.cross(*moved), axis=1, keepdims=True))


def test_newton_converges_quadratically(random):
    calls = []

    def bend(x):
        calls.append(len(x))
        return x + 0.3 * np.sin(x[:, [1, 2, 0]])

    def jacobian(x):
        matrix = np.tile(np.eye(3), (len(x), 1, 1))
        for row, column in enumerate((1, 2, 0)):
            matrix[:, row, column] += 0.3 * np.cos(x[:, column])
        return matrix

    x = random.normal(size=(200, 3))
    found = invert(bend, jacobian, bend(x), tolerance=1e-14, iterations=20)
    assert np.abs(found - x).max() < 1e-13
    assert len(calls) < 20


def test_a_strong_turn_is_followed_from_the_identity(random):
    """A vortex of 170 degrees at its heart, on which Newton's method from the image fails for some points."""

    def angle(p):
        return 3.0 * np.exp(-(p[:, 0] ** 2 + p[:, 1] ** 2) / 0.3)

    def turn(p):
        c, s = np.cos(angle(p)), np.sin(angle(p))
        return np.column_stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]])

    def jacobian(p):
        h = 1e-6
        return np.stack([(turn(p + h * e) - turn(p - h * e)) / (2 * h) for e in np.eye(3)], axis=-1)

    x = random.normal(size=(500, 3)) * 0.6
    assert np.abs(turn(invert(turn, jacobian, turn(x), tolerance=1e-11, iterations=50)) - turn(x)).max() < 1e-9
    assert np.abs(invert(turn, jacobian, turn(x), tolerance=1e-11, iterations=50) - x).max() < 1e-8
