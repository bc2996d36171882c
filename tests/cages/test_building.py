"""Cages that are built enclose what they are built around; the check names what is wrong with others."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from pyvista import examples

from pliant.cages.boxes import cage_from_box
from pliant.cages.building import build_cage
from pliant.cages.checking import check_cage
from pliant.errors import InvalidParameter, InvalidTarget
from pliant.examples import vase
from pliant.field.volumes import volume
from pliant.io.meshes import read
from pliant.mesh import PolygonMesh
from pliant.space.cage import Cage

VASE = vase(around=32, along=24)
OPEN = PolygonMesh(VASE.points, list(VASE.faces)[200:-60])


def two_vases():
    count = len(VASE.points)
    faces = [*VASE.faces, *(face + count for face in VASE.faces)]
    return PolygonMesh(np.vstack([VASE.points, VASE.points + [400, 0, 0]]), faces)


@pytest.mark.parametrize(
    ("mesh", "vertices"),
    [
        pytest.param(VASE, 60, id="closed"),
        pytest.param(OPEN, 80, id="open"),
        pytest.param(two_vases(), 120, id="two components"),
        pytest.param(read(examples.planefile), 150, id="not manifold, thin"),
        pytest.param(read(examples.antfile), 200, id="fifteen components"),
        pytest.param(read(examples.nutfile), 80, id="with a hole"),
    ],
)
def test_built_cages_pass_the_check_and_give_the_mesh_back(mesh, vertices):
    cage = build_cage(mesh, vertices=vertices, margin=0.04)
    report = check_cage(cage, mesh, vertices=vertices)
    assert report.ok, report.failures
    assert report.vertices <= vertices
    assert report.clearance > 0
    if report.volume_ratio is not None:
        assert 1 < report.volume_ratio < 20
    for kind in ("mean_value", "green"):
        deformer = Cage(cage, coordinates=kind, outside="refuse")
        assert np.abs(deformer.bind(mesh).deform() - mesh.points).max() < 1e-12 * mesh.diagonal


def test_tightness_is_the_ratio_of_volumes():
    cage = cage_from_box(VASE, margin=0.1)
    report = check_cage(cage, VASE)
    assert report.ok
    assert report.volume_ratio == pytest.approx(volume(cage) / volume(VASE))
    assert (report.components, report.genus, report.faces) == (1, 0, 6)
    assert report.clearance == pytest.approx(0.1)


def test_boxes_have_the_cells_and_the_room_that_was_asked_for():
    cage = cage_from_box(VASE, cells=(2, 3, 4), margin=0.05)
    assert len(cage.faces) == 2 * (2 * 3 + 3 * 4 + 2 * 4)
    assert cage.edge_use == (0, 0)
    assert len(cage.points) - len(cage.edges) + len(cage.faces) == 2
    room = 0.05 * VASE.diagonal
    assert np.allclose(cage.bounds[0], VASE.bounds[0] - room)
    assert volume(cage) == pytest.approx(np.prod(VASE.bounds[1] - VASE.bounds[0] + 2 * room))


def faulty():
    box = cage_from_box(VASE)
    triangles = box.triangles
    small = box.with_points(VASE.center + 0.5 * (box.points - VASE.center))
    pinched = PolygonMesh(
        np.vstack([box.points, box.points[1:] + 2 * (box.points[0] - box.points[1:])]),
        np.vstack([triangles, np.where(triangles == 0, 0, triangles + 7)[:, ::-1]]),
    )
    twin = PolygonMesh(np.vstack([box.points, box.points + 0.1]), np.vstack([triangles, triangles + 8]))
    return [
        (PolygonMesh(box.points, triangles[1:]), r"open: 3 edges have one face"),
        (PolygonMesh(box.points, triangles[:, ::-1]), "inside out"),
        (PolygonMesh(box.points, np.vstack([triangles[1:], triangles[:1, ::-1]])), "oriented against each other"),
        (pinched, "1 vertices join fans that only touch, the first is 0"),
        (twin, "cuts itself"),
        (small, r"of [\d,]+ vertices are outside, the first is"),
        (small, "triangles of the mesh cut through it"),
        (PolygonMesh(np.vstack([box.points, [[0, 0, 0]]]), triangles), "1 vertices belong to no face, the first is 8"),
        (PolygonMesh(box.points), "it has no faces"),
        (
            box.with_points(np.where(np.arange(8)[:, None] == 1, box.points[0], box.points)),
            "have no area, the first is",
        ),
    ]


@pytest.mark.parametrize(("cage", "message"), faulty())
def test_the_check_names_what_fails(cage, message):
    import re

    report = check_cage(cage, VASE)
    assert not report.ok
    assert any(re.search(message, failure) for failure in report.failures), report.failures


def test_a_face_may_cut_through_though_every_vertex_is_inside():
    bar = PolygonMesh([[-1, 0, 0.9], [1, 0, 0.9], [0, 0.1, 0.9]], [[0, 1, 2]])
    notch = cage_from_box(PolygonMesh([[-1.2, -1, 0], [1.2, 1, 1.0]]), cells=(2, 1, 1), margin=0.05)
    points = notch.points.copy()
    points[(np.abs(points[:, 0]) < 0.1) & (points[:, 2] > 0.5), 2] = 0.3
    report = check_cage(notch.with_points(points), bar)
    assert any("cut through" in failure for failure in report.failures)


def test_the_budget_is_checked():
    assert not check_cage(cage_from_box(VASE, cells=(3, 3, 3)), VASE, vertices=20).ok


def test_bad_wishes_are_named():
    with pytest.raises(InvalidParameter, match="8 is the least"):
        build_cage(VASE, vertices=4)
    with pytest.raises(InvalidParameter, match="margin is 0"):
        build_cage(VASE, margin=0)
    with pytest.raises(InvalidParameter, match="'offset' or 'alpha_wrap'"):
        build_cage(VASE, method="magic")
    with pytest.raises(InvalidTarget, match="has none"):
        build_cage(PolygonMesh(VASE.points))


def test_beside_other_threads_the_same_cage_is_built():
    """There libigl works in a process of its own."""
    mesh = vase(200, 24, 16)
    with ThreadPoolExecutor(1) as pool:
        beside = pool.submit(build_cage, mesh, 60).result()
    here = build_cage(mesh, 60)
    assert beside.points.tolist() == here.points.tolist()
    assert beside.triangles.tolist() == here.triangles.tolist()
