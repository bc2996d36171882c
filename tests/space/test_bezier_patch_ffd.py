from math import comb

import numpy as np
import pytest

from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.space.bezier_patch_ffd import BezierPatchFFD
from pliant.testing import check_deformer


def displaced(patch, size=0.05, seed=1):
    return patch.moved(patch.rest + np.random.default_rng(seed).normal(size=patch.rest.shape) * size)


@pytest.mark.parametrize("outside", ["identity", "extend"])
@pytest.mark.parametrize("shape", [(4, 4), (2, 5), (2, 2), (6, 3)])
def test_laws(random, shape, outside):
    points = random.random((200, 3)) * [2, 1, 0.4]
    check_deformer(displaced(BezierPatchFFD.around(points, shape=shape, margin=0.05, outside=outside)), points)


def test_laws_on_a_mesh(box_mesh):
    check_deformer(displaced(BezierPatchFFD.around(box_mesh, axis="y", margin=0.01)), box_mesh)


def test_points_of_the_plane_lie_on_the_surface_term_by_term(random):
    patch = displaced(BezierPatchFFD.around(random.random((50, 3)), shape=(3, 5)))
    parameters = random.random((40, 2))
    expected = sum(
        comb(2, i) * s**i * (1 - s) ** (2 - i) * comb(4, j) * t**j * (1 - t) ** (4 - j) * patch.controls[i, j, 0]
        for i in range(3)
        for j in range(5)
        for s, t in [parameters.T[:, :, None]]
    )
    assert np.abs(patch(patch.origin + parameters @ patch.edges.T) - expected).max() < 1e-14


def test_points_off_the_plane_keep_their_distance_along_the_normal(random):
    patch = displaced(BezierPatchFFD.around(random.random((50, 3))), 0.1)
    on = patch.origin + random.random((60, 2)) @ patch.edges.T
    height = random.normal(size=(60, 1)) * 0.2
    foot, jacobian = patch(on), patch.jacobian(on)
    normal = np.cross(jacobian @ patch.edges[:, 0], jacobian @ patch.edges[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert np.abs(patch(on + height * patch.normal) - foot - height * normal).max() < 1e-13


def test_a_turned_plane_turns_what_stands_on_it(random):
    points, turn = random.random((80, 3)), np.linalg.qr(random.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    for axis in "xyz":
        patch = BezierPatchFFD.around(points, axis=axis)
        assert np.abs(patch.moved(patch.rest @ turn.T + 1)(points) - points @ turn.T - 1).max() < 1e-13


def test_a_plane_rolled_up_becomes_a_tube(random):
    """A sheet on a cubic arc of a quarter circle: distances from the axis are the radius plus the heights."""
    points = random.random((200, 3)) * [1, 1, 0.1]
    patch = BezierPatchFFD.around(points, shape=(4, 2))
    kappa = 4 / 3 * np.tan(np.pi / 8)
    arc = np.array([[0, 1], [kappa, 1], [1, kappa], [1, 0]])
    controls = patch.rest.copy()
    controls[..., 0], controls[..., 2] = arc[:, 0, None, None], arc[:, 1, None, None]
    height = points[:, 2] - patch.origin[2]
    radius = np.linalg.norm(patch.moved(controls)(points)[:, [0, 2]], axis=1)
    assert np.abs(radius - 1 - height).max() < 3e-4  # the arc's own error


def test_a_collapsed_patch_has_the_planes_normal(random):
    points = random.random((50, 3))
    patch = BezierPatchFFD.around(points)
    flat = patch.moved(np.zeros_like(patch.rest))
    result = flat(points)
    assert np.abs(result[:, :2]).max() < 1e-14
    assert np.abs(result[:, 2] - (points[:, 2] - patch.origin[2])).max() < 1e-14
    assert np.isfinite(flat.jacobian(points)).all()


def test_outside_policies(random):
    inside, beside = random.random((30, 3)), random.random((20, 3)) + [2, 0, 0]
    points = np.concatenate([inside, beside])
    for outside, moves in (("identity", 0.0), ("extend", 1.0)):
        patch = BezierPatchFFD.around(inside, outside=outside)
        moved = patch.moved(patch.rest + 1.0)(points) - points
        assert np.abs(moved[:30] - 1).max() < 1e-12
        assert np.abs(moved[30:] - moves).max() < 1e-10
    with pytest.raises(OutsideDomain, match="20 of 50 points are beside the patch, the first is point 30"):
        BezierPatchFFD.around(inside, outside="error")(points)


def test_errors_name_cause_and_cure(random):
    points = random.random((20, 3))
    with pytest.raises(InvalidDeformer, match="two control points or more"):
        BezierPatchFFD.around(points, shape=(1, 4))
    with pytest.raises(InvalidDeformer, match="'x', 'y' or 'z'"):
        BezierPatchFFD.around(points, axis="q")
    with pytest.raises(InvalidDeformer, match="do not span a plane"):
        BezierPatchFFD(displacements=np.zeros((2, 2, 1, 3)), origin=np.zeros(3), edges=np.ones((3, 2)))
    with pytest.raises(InvalidDeformer, match=r"\(l, m, 1, 3\) is needed"):
        BezierPatchFFD(displacements=np.zeros((2, 2, 3)), origin=np.zeros(3), edges=np.eye(3)[:, :2])
    with pytest.raises(InvalidDeformer, match="not finite"):
        BezierPatchFFD(displacements=np.zeros((2, 2, 1, 3)), origin=np.full(3, np.nan), edges=np.eye(3)[:, :2])
