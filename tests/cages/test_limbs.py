"""Cages by cuts around bodies with limbs: closed, simple and enclosing, whatever way regions are linked."""

from __future__ import annotations

import numpy as np
import pytest
from limbed_bodies import QUADRUPED_CUTS, figure, quadruped

from pliant.cages.builder import CageBuilder
from pliant.cages.checking import check_cage
from pliant.cages.parting import parted
from pliant.cages.sections import Cut, cut_loop, triangle_edges
from pliant.errors import NotConverged
from pliant.field.volumes import volume
from pliant.mesh import PolygonMesh


def with_cuts(mesh, cuts, **options):
    builder = CageBuilder(mesh, **options)
    for origin, normal in cuts:
        builder = builder.cut(origin, normal)
    return builder


def test_a_body_with_limbs_gets_a_cage_that_passes_the_check():
    mesh = quadruped()
    cage = with_cuts(mesh, QUADRUPED_CUTS).build(rounds=1)
    report = check_cage(cage, mesh)
    assert report.ok, report.failures
    assert (report.components, report.genus) == (1, 0)
    assert report.volume_ratio < 4
    assert len(cage.points) < 250


def test_a_plane_through_both_legs_counts_for_the_one_around_its_origin():
    mesh = figure()
    edges = triangle_edges(mesh)
    for x in (-0.21, 0.21):
        loop = cut_loop(mesh, edges, Cut(np.array([x, 0.0, -0.5]), np.array([0.0, 0.0, 1.0])), 0)
        assert (np.sign(loop.points[:, 0]) == np.sign(x)).all()
        assert np.abs(loop.points[:, 2] + 0.5).max() < 1e-9
    beside = cut_loop(mesh, edges, Cut(np.array([0.9, 0.0, -0.5]), np.array([0.0, 0.0, 1.0])), 0)
    assert (beside.points[:, 0] > 0).all()  # outside of all: the nearest


def test_parting_keeps_the_surface_and_gives_each_side_of_a_cut_its_region():
    mesh = quadruped()
    builder = with_cuts(mesh, QUADRUPED_CUTS)
    parts = parted(mesh, builder.cuts)
    whole = PolygonMesh(parts.points, parts.triangles)
    assert whole.edge_use == (0, 0)
    assert volume(whole) == pytest.approx(volume(mesh), rel=1e-5)  # places on edges are kept off their ends
    assert len(np.unique(parts.region)) == len(QUADRUPED_CUTS) + 1  # a tree of limbs
    for cut, rim, (below, above) in zip(builder.cuts, parts.rims, parts.sides, strict=True):
        flat = parts.points[rim] - parts.points[rim].mean(axis=0)
        area = np.cross(flat, np.roll(flat, -1, axis=0)).sum(axis=0) / 2
        assert area @ cut.normal > 0  # counter-clockwise
        for region, sign in ((below, -1), (above, 1)):
            near = np.isin(parts.triangles, rim).any(axis=1) & (parts.region == region)
            heights = (parts.points[parts.triangles[near]] - cut.origin) @ cut.normal
            assert (sign * heights.sum(axis=1) > -1e-6).all()


def test_a_mesh_with_holes_is_cut_as_if_they_were_closed():
    mesh = quadruped()
    middle = mesh.points[mesh.triangles].mean(axis=1)
    holes = np.linalg.norm(middle - [0.3, 0, 0.28], axis=1) < 0.12
    holes |= np.linalg.norm(middle - [0, 0.26, 0], axis=1) < 0.1  # where a cut goes through
    opened = PolygonMesh(mesh.points, mesh.triangles[~holes])
    assert holes.sum() > 10
    assert opened.edge_use[0] > 0
    cage = with_cuts(opened, QUADRUPED_CUTS).build(rounds=0)
    assert check_cage(cage, opened).ok


def test_a_mesh_that_is_inside_out_gets_a_cage_too():
    mesh = quadruped()
    inside_out = PolygonMesh(mesh.points, mesh.triangles[:, ::-1])
    found = with_cuts(inside_out, QUADRUPED_CUTS).construct(rounds=0)
    assert check_cage(found.cage, mesh).ok
    assert not found.left_out


def test_progress_is_told_and_may_end_the_work():
    parts = []
    builder = with_cuts(quadruped(), QUADRUPED_CUTS)
    builder.build(rounds=0, progress=parts.append)
    assert parts[0] == 0.0
    assert parts == sorted(parts)
    assert parts[-1] < 1

    def stop(part):
        raise NotConverged("stopped")

    with pytest.raises(NotConverged, match="stopped"):
        builder.build(progress=stop)
