"""Control points that are put somewhere while joints stay smooth: they go there, and the Jacobian does not jump."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.errors import InvalidControls, InvalidDeformer
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.extended_ffd import ExtendedFFD
from pliant.space.smooth_dragging import SmoothDrag, has_joints

CORNERS = np.array([[0.0, 0, 0], [1, 1, 1]])
BLOCK = BezierFFD.around(CORNERS, patches=(2, 2, 1))


def counted(*places):
    """Control points of the block, counted through."""
    return np.ravel_multi_index(np.array(places).T, BLOCK.shape)


def jump(controls):
    """The largest jump of the Jacobian across the joint at x = 0.5."""
    ffd = BLOCK.moved(controls.reshape(BLOCK.rest.shape))
    y, z = np.meshgrid([0.1, 0.37, 0.63, 0.9], [0.2, 0.5, 0.8])
    where = np.column_stack([np.full(y.size, 0.5), y.ravel(), z.ravel()])
    aside = np.array([1e-9, 0, 0])
    return np.abs(ffd.jacobian(where - aside) - ffd.jacobian(where + aside)).max()


@pytest.mark.parametrize(
    "places",
    [[(3, 1, 1)], [(2, 4, 2)], [(3, 3, 1), (3, 4, 1)], [(2, 1, 1), (3, 1, 1), (4, 1, 1)], [(1, 1, 1), (2, 1, 1)]],
    ids=["a joint", "beside it", "two of a joint", "a joint with its neighbours", "one beside another"],
)
def test_points_go_where_they_are_put_and_joints_stay_smooth(places):
    index = counted(*places)
    shift = np.array([0.05, -0.02, 0.1])
    rest = BLOCK.rest.reshape(-1, 3)
    moved = SmoothDrag(BLOCK, index).controls(rest[index] + shift)
    assert np.array_equal(moved[index], rest[index] + shift)
    assert jump(moved) < 1e-6


def test_alone_they_would_leave_a_kink():
    moved = BLOCK.rest.reshape(-1, 3).copy()
    moved[counted((2, 1, 1))] += [0, 0, 0.1]
    assert jump(moved) > 1e-2


def test_it_adds_to_what_has_been_moved_before():
    bent = BLOCK.moved_smoothly({(3, 2, 1): [0, 0, 0.2], (5, 5, 2): [0.1, 0, 0]})
    index = counted((3, 3, 2))
    start = bent.controls.reshape(-1, 3)
    assert np.abs(SmoothDrag(bent, index).controls(start[index]) - start).max() < 1e-15
    assert jump(SmoothDrag(bent, index).controls(start[index] + [0, 0.1, 0.1])) < 1e-6


def test_round_lattices_take_the_other_side_of_a_ring_along():
    tube = ExtendedFFD.cylinder(np.random.default_rng(1).uniform(-1, 1, (60, 3)), shape=(8, 4, 7))
    assert has_joints(tube)
    joint = tube.blocks[0].index[0, 2, 3]
    moved = SmoothDrag(tube, np.array([joint])).controls(tube.rest[[joint]] + [0, 0, 1.0])
    expected = tube.moved_smoothly({int(joint): [0, 0, 1.0]}).controls
    np.testing.assert_allclose(moved, expected, atol=1e-12)


def test_what_has_no_joints_is_refused():
    assert not has_joints(BezierFFD.around(CORNERS))
    assert not has_joints(BSplineFFD.around(CORNERS, (4, 4, 4)))
    with pytest.raises(InvalidDeformer, match="no joints"):
        SmoothDrag(BezierFFD.around(CORNERS), np.array([0]))
    with pytest.raises(InvalidControls, match="each once"):
        SmoothDrag(BLOCK, np.array([4, 4]))
    with pytest.raises(InvalidControls, match="shape"):
        SmoothDrag(BLOCK, np.array([0])).controls(np.zeros((2, 3)))
