"""Distances along a surface: by two solvers, against what is known in a plane."""

import numpy as np
from surface_shapes import sheet, two_legs

from pliant.numerics.meshes import geodesics
from pliant.numerics.meshes.geodesics import GeodesicDistances, geodesic_distance
from pliant.numerics.meshes.heat import HeatDistances


def test_the_heat_method_on_the_triangles_themselves_is_straight_in_a_plane():
    flat = sheet(41, 41)
    middle = 20 * 41 + 20
    found = HeatDistances(flat.points, flat.triangles)(np.array([middle]))
    straight = np.linalg.norm(flat.points - flat.points[middle], axis=1)
    assert np.abs(found - straight).max() < 0.08 * straight.max()


def test_large_surfaces_are_measured_by_it_and_what_is_known_of_one_is_kept(monkeypatch):
    mesh = two_legs()
    usual = geodesic_distance(mesh.points, mesh.triangles, np.array([0]))
    monkeypatch.setattr(geodesics, "_MANY", 0)
    measured = GeodesicDistances(mesh.points, mesh.triangles)
    assert not measured.ready
    measured.prepare()
    assert measured.ready
    found = measured(np.array([0]))
    near = np.isfinite(usual)
    assert (np.isfinite(found) == near).all()
    assert np.abs(found[near] - usual[near]).max() < 0.15 * usual[near].max()
    both = measured(np.array([0, len(mesh.points) - 1]))
    assert np.isfinite(both).all()
    np.testing.assert_array_equal(both[near], found[near])
    np.testing.assert_array_equal(measured(np.array([0])), found)


def test_triangles_without_area_are_measured_along_edges(monkeypatch):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [4, 0, 0]])
    triangles = np.array([[0, 1, 2], [1, 2, 3]], np.int32)
    for many in (0, 10):
        monkeypatch.setattr(geodesics, "_MANY", many)
        np.testing.assert_allclose(geodesic_distance(points, triangles, np.array([0])), [0, 1, 2, 4], atol=0.02)
