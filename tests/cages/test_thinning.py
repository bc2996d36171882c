"""Surfaces made coarser: sound at any number of vertices, rings in their planes, quadrangles of their triangles."""

from __future__ import annotations

import numpy as np
import pytest
from limbed_bodies import quadruped

from pliant.cages.quads import with_quads
from pliant.cages.ringed_shell import nearest_loops, ringed_shell
from pliant.cages.sections import Cut, edges_of
from pliant.cages.thinning import Thinning, sectors
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.manifold import manifold_faults
from pliant.numerics.meshes.triangle_crossings import crossings, self_crossings
from pliant.numerics.ragged import Ragged

CUTS = (Cut(np.zeros(3), np.array([1.0, 0, 0])), Cut(np.array([-0.6, 0.19, -0.55]), np.array([0.0, 0, -1])))


def test_a_surface_is_sound_at_every_number_of_vertices():
    mesh = quadruped()
    found = ringed_shell(mesh, CUTS, 6, 0.04 * mesh.diagonal)
    rings = [(ring.rim, ring.cut.normal, ring.corners) for ring in found.rings]
    thinning = Thinning(mesh, found.surface.points, found.surface.triangles, rings)
    room = 0.2 * found.shell.offset
    for wanted in (2000, 300, 60):
        thinning.collapse(wanted, room, found.shell.offset)
        thinning.flip(room)
        thinning.smooth(0.5, room)
        points, triangles, left = thinning.surface()
        assert len(points) == thinning.vertices <= wanted
        assert manifold_faults(Ragged.of(triangles), len(points)).none
        assert not len(self_crossings(points, triangles))
        assert not len(crossings(points, triangles, mesh.points, mesh.triangles))
        for ring, cut in zip(left, CUTS, strict=True):
            assert np.abs((points[ring] - cut.origin) @ cut.normal).max() < 1e-9 * mesh.diagonal
    assert thinning.rings_done
    assert [len(ring) for ring in left] == [6, 6]
    inward = -0.9 * room  # what stays between the mesh and a face
    normals = np.cross(*(points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2)))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shifted = points[triangles] + inward * normals[:, None]
    alone = np.arange(3 * len(triangles)).reshape(-1, 3)
    touched = crossings(shifted.reshape(-1, 3), alone, mesh.points, mesh.triangles)
    assert len(np.unique(touched[:, 0])) < 0.05 * len(triangles)


def test_quadrangles_are_made_of_their_triangles():
    mesh = quadruped()
    found = ringed_shell(mesh, CUTS, 5, 0.04 * mesh.diagonal)
    thinning = Thinning(mesh, found.surface.points, found.surface.triangles, [])
    thinning.collapse(150, 0.1 * found.shell.offset, found.shell.offset)
    points, triangles, _ = thinning.surface()
    kept = triangles[0]
    cage = PolygonMesh(points, Ragged.of(with_quads(points, triangles, [kept])))
    turned = {tuple(np.roll(face, -int(np.argmin(face))).tolist()) for face in triangles}
    assert {tuple(np.roll(face, -int(np.argmin(face))).tolist()) for face in cage.triangles} == turned
    assert (cage.faces.lengths == 4).sum() > 20
    assert sorted(kept.tolist()) in [sorted(face.tolist()) for face in cage.faces]  # rings stay edges


@pytest.mark.parametrize("count", [7, 40])
def test_each_corner_of_a_ring_has_a_run_of_its_loop(count):
    angles = 2 * np.pi * (np.arange(count) + 0.3) / count
    loop = np.stack([2 * np.cos(angles), np.sin(angles), np.zeros(count)], axis=1)
    around = 2 * np.pi * np.arange(6) / 6
    corners = np.stack([3 * np.cos(around), 2 * np.sin(around), np.zeros(6)], axis=1)
    found = sectors(loop, corners)
    assert set(found.tolist()) == set(range(6))
    changes = np.count_nonzero(found != np.roll(found, 1))
    assert changes == 6


def test_the_nearest_loop_is_found_along_the_surface():
    points = np.column_stack([np.arange(12.0), np.zeros(12), np.zeros(12)])
    edges = np.stack([np.arange(11), np.arange(1, 12)], axis=1)[[0, 1, 2, 3, 4, 5, 6, 7, 8, 10]]
    near = Cut(np.array([1.5, 0, 0]), np.array([1.0, 0, 0]))
    far = Cut(np.array([6.5, 0, 0]), np.array([1.0, 0, 0]))
    found = nearest_loops(points, edges, [(near, np.array([1])), (far, np.array([6]))])
    assert found.tolist() == [0, 0, 1, 1, 2, 2, 2, 3, 3, 3, -1, -1]


def test_edges_are_listed_once():
    triangles = quadruped().triangles
    every = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    np.testing.assert_array_equal(edges_of(triangles), np.unique(every, axis=0))
