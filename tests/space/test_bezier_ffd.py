from math import comb

import numpy as np
import pytest

from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.space.bezier_ffd import BezierFFD
from pliant.testing import check_deformer


def bent(points, size=0.05, seed=3, **options):
    lattice = BezierFFD.around(points, **options)
    return lattice.moved(lattice.rest + np.random.default_rng(seed).normal(size=lattice.rest.shape) * size)


def naive(ffd, points):
    """Sederberg & Parry 1986, eq. 1 by cross products and eq. 3 term by term."""
    s_edge, t_edge, u_edge = ffd.edges.T
    volume = np.cross(t_edge, u_edge) @ s_edge
    result = []
    for x in points:
        d = x - ffd.origin
        parameters = [np.cross(t_edge, u_edge) @ d, np.cross(u_edge, s_edge) @ d, np.cross(s_edge, t_edge) @ d]
        bases = [
            [comb(n - 1, i) * (p / volume) ** i * (1 - p / volume) ** (n - 1 - i) for i in range(n)]
            for n, p in zip(ffd.shape, parameters, strict=True)
        ]
        result.append(np.einsum("i,j,k,ijkc->c", *bases, ffd.controls))
    return np.array(result)


@pytest.mark.parametrize("outside", ["identity", "extend"])
@pytest.mark.parametrize(
    "options", [{"shape": (4, 4, 4)}, {"shape": (3, 7, 2)}, {"patches": (2, 1, 3)}, {"shape": (4, 3, 1)}]
)
def test_laws(random, options, outside):
    points = random.random((200, 3)) * [2, 3, 1]
    ffd = bent(points, margin=0.02, outside=outside, **options)
    check_deformer(ffd, points)


@pytest.mark.parametrize("shape", [(4, 4, 4), (3, 5, 2), (10, 10, 10)])
def test_agrees_with_the_papers_sum_on_a_skewed_parallelepiped(random, shape):
    edges = np.eye(3) + random.normal(size=(3, 3)) * 0.3
    ffd = BezierFFD(displacements=random.normal(size=(*shape, 3)) * 0.1, origin=random.normal(size=3), edges=edges)
    points = ffd.origin + random.random((40, 3)) @ edges.T
    assert np.abs(ffd(points) - naive(ffd, points)).max() < 1e-13


def test_patches_agree_with_one_hyperpatch_each(random):
    points = random.random((400, 3))
    block = bent(points, patches=(2, 3, 1))
    for i in range(2):
        for j in range(3):
            part = BezierFFD(
                displacements=block.displacements[3 * i : 3 * i + 4, 3 * j : 3 * j + 4],
                origin=block.origin + block.edges @ [i / 2, j / 3, 0],
                edges=block.edges / [2, 3, 1],
            )
            inside = block.origin + ((random.random((50, 3)) + [i, j, 0]) / [2, 3, 1]) @ block.edges.T
            assert np.abs(block(inside) - part(inside)).max() < 1e-14


def test_box_corners_belong_to_the_box_after_a_rotation(random):
    for angle in random.random(50) * 7:
        c, s = np.cos(angle), np.sin(angle)
        axes = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        corners = np.stack(np.meshgrid([0, 2.0], [0, 3.0], [0, 1.0]), axis=-1).reshape(-1, 3) @ axes.T
        lattice = BezierFFD.around(corners, shape=(3, 3, 3), axes=axes, outside="error")
        moved = lattice.moved(lattice.rest + [1.0, 0, 0])(corners)
        assert np.abs(moved - corners - [1, 0, 0]).max() < 1e-12


def test_outside_policies(random):
    inside, outside = random.random((50, 3)), random.random((30, 3)) + 2
    points = np.vstack([inside, outside])
    controls_shift = 0.2
    for options in ({"shape": (4, 4, 4)}, {"shape": (3, 3, 3)}, {"patches": (2, 2, 2)}):
        lattice = BezierFFD.around(inside, outside="identity", **options)
        moved = lattice.moved(lattice.rest + controls_shift)(points)
        assert np.array_equal(moved[50:], outside)
        assert np.abs(moved[:50] - inside - controls_shift).max() < 1e-13
        extended = BezierFFD.around(inside, outside="extend", **options)
        assert np.abs(extended.moved(extended.rest + controls_shift)(points) - points - controls_shift).max() < 1e-10
        refused = BezierFFD.around(inside, outside="error", **options)
        with pytest.raises(OutsideDomain, match="does not contain 30 of 80 points, the first is point 50"):
            refused(points)


def test_smooth_moves_keep_joints_c1(random):
    block = BezierFFD.around(random.random((50, 3)), patches=(2, 2, 2))
    moves = {tuple(i): random.normal(size=3) * 0.05 for i in random.integers(0, 7, size=(12, 3))}
    smooth = block.moved_smoothly(moves)
    rough = block.moved(block.rest + (smooth.displacements != 0) * random.normal(size=block.rest.shape) * 0.05)
    faces = random.random((200, 3))
    faces[np.arange(200), random.integers(0, 3, 200)] = 0.5
    where = block.origin + faces @ block.edges.T

    def jump(ffd):
        before, after = (ffd.jacobian(where + side * 1e-9 * block.edges.sum(axis=1)) for side in (-1, 1))
        return np.abs(after - before).max()

    assert jump(smooth) < 1e-6 < 0.01 < jump(rough)


def test_a_smooth_move_goes_where_it_was_asked(random):
    block = BezierFFD.around(random.random((50, 3)), patches=(2, 1, 1))
    moved = block.moved_smoothly({(3, 0, 0): [0, 0, 1.0]})
    assert np.array_equal(np.argwhere(moved.displacements.any(axis=-1)), [[2, 0, 0], [3, 0, 0], [4, 0, 0]])
    mirrored = block.moved_smoothly({(2, 0, 0): [0, 0, 1.0]})
    assert np.array_equal(mirrored.displacements[4, 0, 0], [0, 0, -1.0])


def test_frozen_layers_join_unmoved_space_smoothly(random):
    for continuity in (0, 1):
        lattice = BezierFFD.around(random.random((50, 3)), shape=(6, 6, 6))
        free = lattice.free(continuity)
        assert free.sum() == (6 - 2 * (continuity + 1)) ** 3
        ffd = lattice.moved(lattice.rest + free[..., None] * random.normal(size=lattice.rest.shape))
        rim = random.random((100, 3))
        rim[np.arange(100), random.integers(0, 3, 100)] = random.integers(0, 2, 100)
        where = ffd.origin + rim @ ffd.edges.T
        assert np.abs(ffd(where) - where).max() < 1e-12
        slope = np.abs(ffd.jacobian(where) - np.eye(3)).max()
        assert slope < 1e-10 if continuity else slope > 1e-2


def test_errors_name_cause_and_cure(random):
    points = random.random((20, 3))
    with pytest.raises(InvalidDeformer, match="either a shape or numbers of patches"):
        BezierFFD.around(points, shape=(4, 4, 4), patches=(1, 1, 1))
    with pytest.raises(InvalidDeformer, match="do not span space"):
        BezierFFD(displacements=np.zeros((2, 2, 2, 3)), origin=np.zeros(3), edges=np.ones((3, 3)))
    with pytest.raises(InvalidDeformer, match=r"have \(4, 4, 4\) control points; the lattice has \(5, 4, 4\)"):
        BezierFFD(displacements=np.zeros((5, 4, 4, 3)), origin=np.zeros(3), edges=np.eye(3), patches=(1, 1, 1))
    with pytest.raises(InvalidDeformer, match="no joints"):
        BezierFFD.around(points).moved_smoothly({(0, 0, 0): [0, 0, 0]})
