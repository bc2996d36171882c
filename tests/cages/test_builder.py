"""Cages built by cuts, from one's own mesh, and symmetric ones: each passes the check."""

from __future__ import annotations

import numpy as np
import pytest
from skimage.measure import marching_cubes

from pliant.cages.boxes import cage_from_box
from pliant.cages.builder import CageBuilder
from pliant.cages.building import build_cage
from pliant.cages.checking import check_cage
from pliant.cages.own import cage_from_mesh
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.examples import vase
from pliant.field.volumes import volume
from pliant.mesh import PolygonMesh

VASE = vase(around=24, along=20)
ARMS = np.array([[1, 0, 0], [-0.5, np.sqrt(0.75), 0.0], [-0.5, -np.sqrt(0.75), 0]])


def star(arms=ARMS, radius=0.22):
    """Round arms that meet in the origin."""
    steps = np.linspace(-1.6, 1.6, 40)
    places = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1)
    along = np.clip(places @ np.asarray(arms).T, 0, 1.2)
    distance = np.linalg.norm(places[..., None, :] - along[..., None] * arms, axis=-1).min(axis=-1)
    points, triangles, _, _ = marching_cubes(distance, radius)
    return PolygonMesh(points * (steps[1] - steps[0]) - 1.6, triangles[:, ::-1])


STAR = star()


def cuts(builder, heights=(0.45, 0.9)):
    for arm in ARMS:
        for height in heights:
            builder = builder.cut(height * arm, arm)
    return builder


def test_limbs_become_tubes_with_caps():
    rough = CageBuilder(VASE, sides=8).cuts_along("z", 4).rough()
    assert len(rough.points) == (4 + 2) * 8  # a ring a cut, and two caps
    assert sorted(rough.faces.lengths.tolist()) == [4] * 5 * 8 + [8] * 2
    assert rough.edge_use == (0, 0)
    assert volume(rough) > 0


def test_three_limbs_meet_in_a_branch():
    rough = cuts(CageBuilder(STAR)).rough()
    assert len(rough.points) == (6 + 3) * 6
    assert rough.edge_use == (0, 0)
    assert len(rough.points) - len(rough.edges) + len(rough.faces) == 2


@pytest.mark.parametrize("builder", [CageBuilder(VASE, sides=8).cuts_along("z", 4), cuts(CageBuilder(STAR))])
def test_what_is_built_passes_the_check(builder):
    cage = builder.build(rounds=2)
    report = check_cage(cage, builder.mesh)
    assert report.ok, report.failures
    assert (report.components, report.genus) == (1, 0)


def test_rounds_make_a_cage_smoother():
    builder = cuts(CageBuilder(STAR))

    def roughness(cage):
        lengths = np.linalg.norm(cage.points[cage.edges[:, 0]] - cage.points[cage.edges[:, 1]], axis=1)
        return (lengths**2).sum()

    assert roughness(builder.build(rounds=3)) < roughness(builder.build(rounds=0))


def test_a_ring_goes_closely_around_its_section():
    builder = CageBuilder(STAR, sides=6, margin=0.02).cut([0.6, 0, 0], [1, 0, 0])
    ring = builder.rough().points[:6]
    room = 0.02 * STAR.diagonal
    assert np.allclose(ring[:, 0], 0.6)
    sides = (ring + np.roll(ring, -1, axis=0)) / 2
    assert np.allclose(np.linalg.norm(sides[:, 1:], axis=1), 0.22 + room, atol=0.01)


def test_bad_cuts_are_named():
    builder = CageBuilder(STAR)
    for make, message in (
        (lambda: builder.rough(), "there is no cut yet"),
        (lambda: builder.cut([9, 9, 9], [1, 0, 0]).rough(), "cut 0 misses the mesh"),
        (lambda: builder.cut([0, 0, 0], [0, 0, 0]), "normal is zero"),
        (lambda: builder.cut([0, 0], [0, 0, 1]), "three finite numbers"),
        (lambda: builder.cuts_along("w", 3), "must be 'x', 'y' or 'z'"),
        (lambda: CageBuilder(STAR, sides=2), "it must be 3 to 64"),
        (lambda: CageBuilder(STAR, margin=0), "margin is 0"),
    ):
        with pytest.raises(InvalidParameter, match=message):
            make()
    two = PolygonMesh(
        np.vstack([STAR.points, STAR.points + 9]), np.vstack([STAR.triangles, STAR.triangles + len(STAR.points)])
    )
    with pytest.raises(InvalidTarget, match="1 pieces of the mesh are cut by no plane"):
        CageBuilder(two).cut([0.6, 0, 0], [1, 0, 0]).rough()
    with pytest.raises(InvalidTarget, match="has none"):
        CageBuilder(PolygonMesh(STAR.points))


def test_ones_own_mesh_is_pushed_out_no_farther_than_needed():
    box = cage_from_box(VASE, cells=(2, 2, 3))
    assert np.array_equal(cage_from_mesh(box, VASE).points, box.points)  # it encloses already
    small = box.with_points(VASE.center + 0.8 * (box.points - VASE.center))
    cage = cage_from_mesh(small, VASE)
    assert check_cage(cage, VASE).ok
    assert cage.faces is small.faces
    reversed_box = PolygonMesh(small.points, [face[::-1] for face in small.faces])
    assert check_cage(cage_from_mesh(reversed_box, VASE), VASE).ok
    with pytest.raises(InvalidTarget, match="3 open edges"):
        cage_from_mesh(PolygonMesh(small.points, small.triangles[1:]), VASE)


def test_symmetric_cages_are_their_own_mirror_image():
    lopsided = STAR.with_points(STAR.points + 0.1 * STAR.points[:, [1, 2, 0]])
    cage = build_cage(lopsided, vertices=80, margin=0.04, symmetry="x")
    assert check_cage(cage, lopsided, vertices=80).ok
    mirrored = cage.points * [-1, 1, 1] + [2 * lopsided.center[0], 0, 0]
    distance = np.linalg.norm(mirrored[:, None] - cage.points, axis=2)
    twin = distance.argmin(axis=1)
    assert distance.min(axis=1).max() == 0
    assert {frozenset(twin[face].tolist()) for face in cage.triangles} == {
        frozenset(f.tolist()) for f in cage.triangles
    }
