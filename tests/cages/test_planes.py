"""Cages by planes over bodies that are made up: always sound, with rings on the planes; what is left out is told."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from limbed_bodies import FIGURE_CUTS, QUADRUPED_CUTS, figure, grown, quadruped

from pliant.cages.builder import CageBuilder
from pliant.cages.checking import check_cage
from pliant.cages.sections import Cut, cut_loop, triangle_edges
from pliant.cages.shell import shell_around
from pliant.cages.splitting import Split, beside, regions_between
from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.manifold import manifold_faults
from pliant.numerics.meshes.triangle_crossings import crossings, self_crossings
from pliant.numerics.ragged import Ragged

SPACING = 0.08  # of bodies that need not be fine


def with_cuts(mesh, cuts, **options):
    builder = CageBuilder(mesh, **options)
    for origin, normal in cuts:
        builder = builder.cut(origin, normal)
    return builder


def sound(found, mesh):
    report = check_cage(found.cage, mesh)
    assert report.ok, report.failures
    assert report.clearance > 0
    return report


def rings_on(found, cut, sides, mesh):
    """Whether as many vertices as a ring has lie in a plane, joined by edges, around its section."""
    origin, normal = np.asarray(cut[0], float), np.asarray(cut[1], float)
    normal = normal / np.linalg.norm(normal)
    on = np.abs((found.cage.points - origin) @ normal) < 1e-9 * mesh.diagonal
    joined = on[found.cage.edges].all(axis=1)
    loop = cut_loop(mesh, triangle_edges(mesh), Cut(origin, normal), 0).points
    near = np.linalg.norm(found.cage.points - loop.mean(axis=0), axis=1) < 3 * np.ptp(loop, axis=0).max()
    return np.count_nonzero(on & near) >= sides and np.count_nonzero(joined) >= sides


@pytest.mark.parametrize(
    ("mesh", "cuts"), [(figure(), FIGURE_CUTS), (quadruped(), QUADRUPED_CUTS)], ids=["figure", "quadruped"]
)
def test_rings_lie_on_their_planes(mesh, cuts):
    found = with_cuts(mesh, cuts, sides=5).construct()
    sound(found, mesh)
    without = {each.number for each in found.left_out}
    assert len(without) <= 2  # a shoulder may be too near to the trunk
    assert all(rings_on(found, cut, 5, mesh) for number, cut in enumerate(cuts) if number not in without)
    assert (found.cage.faces.lengths == 4).sum() > len(found.cage.faces) / 4  # what is between rings is quadrangles


tubes = st.integers(0, 10**6).map(np.random.default_rng)


def branching(random):
    """Bars that grow from one another at random: they may meet again, touch, or lie side by side."""
    bars, cuts = [([0, 0, -0.6], [0, 0, 0.6], 0.25)], [([0, 0, 0], [0, 0, 1])]
    for _ in range(random.integers(1, 5)):
        one, two, _ = bars[random.integers(len(bars))]
        start = np.asarray(one) + random.uniform(0, 1) * (np.asarray(two) - one)
        way = random.normal(size=3)
        end = start + random.uniform(0.5, 1.0) * way / np.linalg.norm(way)
        bars.append((start, end, random.uniform(0.12, 0.2)))
        cuts.append(((start + 2 * end) / 3, end - start))
    return grown(bars, SPACING), cuts


@settings(max_examples=3, deadline=None, derandomize=True)
@given(random=tubes)
def test_branching_tubes_get_sound_cages_whatever_the_planes(random):
    mesh, cuts = branching(random)
    cuts += [(mesh.points[random.integers(len(mesh.points))], random.normal(size=3)) for _ in range(3)]
    builder = with_cuts(mesh, cuts, sides=int(random.integers(3, 9)), margin=float(random.uniform(0.03, 0.06)))
    found = builder.construct(rounds=1)
    sound(found, mesh)
    assert {each.number for each in found.left_out} <= set(range(len(cuts)))
    assert all(each.reason for each in found.left_out)


@settings(max_examples=2, deadline=None, derandomize=True)
@given(random=tubes)
def test_bodies_that_cut_themselves_get_sound_cages(random):
    mesh, cuts = branching(random)
    pierced = np.array(mesh.points)
    moved = pierced[:, 0] > np.median(pierced[:, 0])
    pierced[moved] += [-0.4, 0.1, 0.0]
    mesh = mesh.with_points(pierced)
    assert len(self_crossings(mesh.points, mesh.triangles))
    sound(with_cuts(mesh, cuts, margin=0.04).construct(rounds=1), mesh)


@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_arms_along_the_trunk_have_rings_of_their_own_where_there_is_a_gap(gap):
    trunk, arm = ([0, 0, -0.8], [0, 0, 0.8], 0.3), ([0.52 + gap, 0, 0.6], [0.52 + gap, 0, -0.9], 0.2)
    shoulder = ([0, 0, 0.7], [0.5 + gap, 0, 0.65], 0.2)
    mesh = grown([trunk, shoulder, arm], 0.03, 0.01)
    cuts = [([0, 0, 0], [0, 0, 1]), ([0.52 + gap, 0, -0.5], [0, 0, -1])]
    found = with_cuts(mesh, cuts, margin=0.02).construct()
    sound(found, mesh)
    if gap == 0.1:  # wide enough for cells
        assert not found.left_out
        assert all(rings_on(found, cut, 6, mesh) for cut in cuts)


def test_planes_that_cross_or_miss_are_left_out_and_told():
    cuts = [([0, 0, 0], [1, 0, 0]), ([0, 0, 0], [1, 0, 0.3]), ([9, 9, 9], [1, 0, 0]), *QUADRUPED_CUTS[1:3]]
    mesh = quadruped()
    found = with_cuts(mesh, cuts).construct(rounds=0)
    sound(found, mesh)
    assert [(each.number, each.reason) for each in found.left_out] == [
        (1, "it crosses another plane on the shape"),
        (2, "it misses the shape"),
    ]
    with pytest.raises(InvalidParameter, match="no cut meets the mesh"):
        with_cuts(mesh, [([9, 9, 9], [1, 0, 0])]).construct()
    with pytest.raises(InvalidParameter, match="there is no cut yet"):
        CageBuilder(mesh).construct()


def test_a_budget_is_kept_where_rings_leave_room():
    mesh = quadruped()
    wide = with_cuts(mesh, QUADRUPED_CUTS, margin=0.04).construct(1, vertices=200).cage
    narrow = with_cuts(mesh, QUADRUPED_CUTS, margin=0.04).construct(1, vertices=90).cage
    assert len(narrow.points) <= 90 < len(wide.points) <= 200
    assert check_cage(narrow, mesh).ok


def test_the_same_planes_give_the_same_cage():
    one, two = (with_cuts(quadruped(), QUADRUPED_CUTS, margin=0.05).construct(rounds=1).cage for _ in range(2))
    np.testing.assert_array_equal(one.points, two.points)
    assert one.faces.flat.tolist() == two.faces.flat.tolist()


def test_loose_triangles_are_enclosed_as_if_they_were_joined():
    mesh = quadruped()
    loose = PolygonMesh(mesh.points[mesh.triangles].reshape(-1, 3), np.arange(3 * len(mesh.triangles)).reshape(-1, 3))
    found = with_cuts(loose, QUADRUPED_CUTS, margin=0.04).construct(rounds=1)
    assert sound(found, loose).components == 1
    assert not found.left_out


@pytest.mark.parametrize("offset", [0.02, 0.08])
def test_shells_are_closed_sound_and_at_their_distance(offset):
    mesh = figure()
    shell = shell_around(mesh, np.zeros(len(mesh.points), int), offset * mesh.diagonal)
    assert manifold_faults(Ragged.of(shell.triangles), len(shell.points)).none
    assert not len(self_crossings(shell.points, shell.triangles))
    assert not len(crossings(shell.points, shell.triangles, mesh.points, mesh.triangles))
    away = np.abs(np.linalg.norm(shell.points[:, None] - mesh.points[None, ::3], axis=2).min(axis=1) - shell.offset)
    assert np.median(away) < 0.5 * shell.spacing


def test_parting_gives_each_side_of_a_rim_its_region():
    builder = with_cuts(quadruped(), QUADRUPED_CUTS)
    from pliant.cages.parting import parted

    parts = parted(builder.mesh, builder.cuts)
    found = Split(parts.points, parts.triangles, parts.rims)
    region = regions_between(found)
    assert len(np.unique(region)) == len(QUADRUPED_CUTS) + 1
    for rim in parts.rims:
        below, above = beside(found, region, rim)
        assert below != above
