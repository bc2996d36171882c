"""Maps as dense grids: the separable product is the sum at each node, and grids converge to their map."""

import numpy as np
import pytest

from pliant.errors import InvalidParameter
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.sampling import to_grid

AXES = Affine.rotation((1, 2, 3), 0.7).linear
BOX = np.array([[0, 0, 0], [2, 3, 1.0]])


def lattice(edge="clamp", affine=None, axes=None, shape=(6, 5, 4)):
    ffd = BSplineFFD.around(BOX, shape=shape, axes=axes, edge=edge, margin=0.1)
    moves = np.random.default_rng(0).normal(size=ffd.rest.shape) * 0.1
    matrix = np.eye(4)
    if affine:
        matrix[:3] += np.random.default_rng(1).normal(size=(3, 4)) * 0.1
    return BSplineFFD(
        displacements=moves, origin=ffd.origin, spacing=ffd.spacing, axes=ffd.axes, edge=edge, affine=matrix
    )


@pytest.mark.parametrize("edge", ["clamp", "zero", "identity"])
@pytest.mark.parametrize("affine", [False, True])
@pytest.mark.parametrize("axes", [None, AXES])
def test_three_products_are_the_sum_at_each_node(edge, affine, axes):
    ffd = lattice(edge, affine, axes)
    wide = np.array([[-1.03, -1.02, -1.01], [3.04, 4.05, 2.06]])  # beyond the lattice too
    grid = to_grid(ffd, wide, shape=(11, 7, 9), axes=axes)
    nodes = grid.rest.reshape(-1, 3)
    assert np.abs(grid.controls.reshape(-1, 3) - ffd(nodes)).max() < 1e-13


def test_other_axes_and_other_maps_are_sampled_point_by_point():
    for deformer in (lattice(axes=AXES), Affine.rotation("x", 0.3)):
        grid = to_grid(deformer, BOX, spacing=0.4)
        assert np.abs(grid.controls.reshape(-1, 3) - deformer(grid.rest.reshape(-1, 3))).max() < 1e-14


@pytest.mark.parametrize(("interpolation", "order"), [("linear", 2), ("cubic", 4)])
def test_grids_converge_to_their_map(random, interpolation, order):
    ffd = lattice(shape=(4, 4, 4))
    points = BOX[0] + (0.3 + 0.4 * random.random((300, 3))) * (BOX[1] - BOX[0])
    errors = []
    for count in (33, 65):
        grid = to_grid(ffd, BOX, shape=(count,) * 3, interpolation=interpolation)
        errors.append(np.abs(grid(points) - ffd(points)).max())
    assert np.log2(errors[0] / errors[1]) > order - 0.5


def test_the_grid_covers_the_box():
    grid = to_grid(Affine(), BOX, spacing=(0.3, 0.5, 2))
    assert grid.shape == (8, 7, 2)
    assert np.allclose(grid.rest[0, 0, 0], BOX[0])
    assert (grid.rest[-1, -1, -1] >= BOX[1]).all()
    assert np.allclose(to_grid(Affine(), BOX, shape=(3, 4, 5)).rest[-1, -1, -1], BOX[1])


@pytest.mark.parametrize(
    "choice", [{}, {"spacing": 1, "shape": (2, 2, 2)}, {"spacing": 0}, {"shape": (0, 1, 1)}, {"spacing": 1e-4}]
)
def test_impossible_grids(choice):
    with pytest.raises(InvalidParameter):
        to_grid(Affine(), BOX, **choice)
