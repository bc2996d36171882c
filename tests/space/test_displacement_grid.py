"""Dense displacement fields: exact at the nodes, exact for fields of their degree, and what SciPy computes."""

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from pliant.errors import InvalidDeformer
from pliant.space.affine import Affine
from pliant.space.displacement_grid import DisplacementGrid
from pliant.testing import check_deformer

AXES = Affine.rotation((1, 2, 3), 0.7).linear


def field(shape=(6, 5, 4), seed=3, size=0.03, **choices):
    values = np.random.default_rng(seed).normal(size=(*shape, 3)) * size
    return DisplacementGrid(displacements=values, origin=(1, -2, 3), spacing=(0.4, 0.5, 0.6), axes=AXES, **choices)


def inside(grid, count, seed=1, beyond=0.0):
    q = np.random.default_rng(seed).uniform(-beyond, np.array(grid.shape) - 1 + beyond, (count, 3))
    return grid.origin + (q * grid.spacing) @ grid.axes.T, q


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("outside", ["identity", "clamp"])
@pytest.mark.parametrize("shape", [(6, 5, 4), (2, 3, 9), (4, 1, 2)])
def test_laws(shape, interpolation, outside):
    grid = field(shape, interpolation=interpolation, outside=outside, rim=0.5)
    points, _ = inside(grid, 200, beyond=1.5)
    points = points[grid.is_smooth(points, 1e-3)]
    check_deformer(grid, points)


@pytest.mark.parametrize(("interpolation", "order"), [("linear", 1), ("cubic", 3)])
def test_agrees_with_scipy(interpolation, order):
    grid = field(interpolation=interpolation)
    points, q = inside(grid, 500)
    expected = [map_coordinates(grid.displacements[..., c], q.T, order=order, mode="mirror") for c in range(3)]
    assert np.abs(grid(points) - points - np.transpose(expected)).max() < 1e-12


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_nodes_move_as_they_say(interpolation):
    grid = field(interpolation=interpolation, rim=0.01)
    nodes = grid.rest.reshape(-1, 3)
    assert np.abs(grid(nodes) - grid.controls.reshape(-1, 3)).max() < 1e-13


def test_affine_fields_are_reproduced_by_linear_grids(random):
    matrix = random.normal(size=(3, 3))
    grid = field()
    grid = grid.moved(grid.rest @ matrix.T + [1, 2, 3])
    points, _ = inside(grid, 300)
    assert np.abs(grid(points) - points @ matrix.T - [1, 2, 3]).max() < 1e-12


def test_the_rim_goes_on_and_then_nothing_moves():
    grid = field(rim=0.5)
    at, out = np.array([[-0.49, 1, 1], [2, 4.49, 1]]), np.array([[-0.51, 1, 1], [2, 4.51, 1], [50, 50, 50]])

    def world(q):
        return grid.origin + (q * grid.spacing) @ grid.axes.T

    nearest = world(np.clip(at, 0, np.array(grid.shape) - 1))
    assert np.abs((grid(world(at)) - world(at)) - (grid(nearest) - nearest)).max() < 1e-14
    assert np.array_equal(grid(world(out)), world(out))


def test_weights_as_a_matrix(random):
    for interpolation in ("linear", "cubic"):
        grid = field(interpolation=interpolation)
        points, _ = inside(grid, 50)
        bound = grid.bind(points)
        change = random.normal(size=grid.rest.shape)
        expected = bound.deform(grid.rest + change) - points
        assert np.abs(bound.matrix() @ change.reshape(-1, 3) - expected).max() < 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"displacements": np.zeros((3, 3, 3))}, "shape"),
        ({"displacements": np.full((2, 2, 2, 3), np.nan)}, "not finite"),
        ({"spacing": (1, 0, 1)}, "positive"),
        ({"spacing": (1, 1)}, "three numbers"),
        ({"axes": np.ones((3, 3))}, "orthonormal"),
        ({"interpolation": "quintic"}, "quintic"),
        ({"outside": "wrap"}, "wrap"),
        ({"rim": -1}, "rim"),
    ],
)
def test_impossible_grids_are_refused(change, message):
    good = {"displacements": np.zeros((2, 2, 2, 3)), "origin": (0, 0, 0), "spacing": (1, 1, 1)}
    with pytest.raises(InvalidDeformer, match=message):
        DisplacementGrid(**{**good, **change})
