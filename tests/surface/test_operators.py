"""Operators against dense linear algebra, and against geometry that is known."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import scipy.sparse as sp
from bad_meshes import bad_meshes
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import sheet, tube, two_legs

from pliant.errors import SingularSystem
from pliant.numerics.meshes.closest_triangles import FacingTriangles, project
from pliant.numerics.meshes.eigenpairs import lowest_eigenpairs
from pliant.numerics.meshes.geodesics import geodesic_distance
from pliant.numerics.meshes.gradients import DeformationGradients, plane_gradients
from pliant.numerics.meshes.laplacians import WEIGHTS, cotangent_weights, laplacian, masses, normalized
from pliant.numerics.rigid.rotations import nearest_rotations, rotations_of, turning_vectors
from pliant.numerics.sparse import fill_reducing
from pliant.numerics.sparse.sparse_cholesky import Cholesky


@settings(max_examples=25, deadline=None)
@given(size=st.integers(1, 400), density=st.floats(0, 0.05), columns=st.integers(1, 7), seed=st.integers(0, 10**6))
def test_the_factor_solves_what_a_dense_solver_does(size, density, columns, seed):
    random = np.random.default_rng(seed)
    part = sp.random_array((size, size), density=density, rng=random)
    matrix = sp.csc_array(part @ part.T + sp.eye_array(size))
    right = random.normal(size=(size, columns))
    factor = Cholesky(matrix)
    expected = np.linalg.solve(matrix.toarray(), right)
    assert np.abs(factor.solve(right) - expected).max() < 1e-10
    assert np.abs(factor.solve(right[:, 0]) - expected[:, 0]).max() < 1e-10
    again = factor.refactored(sp.csc_array(2 * matrix))
    assert np.abs(again.solve(right) - expected / 2).max() < 1e-10
    assert np.array_equal(pickle.loads(pickle.dumps(factor)).solve(right), factor.solve(right))


def test_it_solves_without_metis_too(monkeypatch):
    mesh = tube(40, 16)
    matrix = sp.csc_array(laplacian(cotangent_weights(mesh.points, mesh.triangles)) + sp.eye_array(len(mesh.points)))
    with_metis = Cholesky(matrix).solve(mesh.points)
    monkeypatch.setattr("pliant.numerics.sparse.sparse_cholesky.nested_dissection", lambda _: None)
    assert np.abs(Cholesky(matrix).solve(mesh.points) - with_metis).max() < 1e-12
    assert fill_reducing.nested_dissection(matrix) is not None


def test_singular_matrices_are_refused():
    mesh = two_legs()
    singular = laplacian(cotangent_weights(mesh.points, mesh.triangles))
    pinned = singular + sp.diags_array((np.arange(len(mesh.points)) == 0).astype(float))
    for matrix in (singular, pinned, sp.csc_array((3, 3)), -sp.eye_array(5)):
        with pytest.raises(SingularSystem):
            Cholesky(matrix)


@settings(max_examples=30, deadline=None)
@given(mesh=bad_meshes(), kind=st.sampled_from(sorted(WEIGHTS)))
def test_weights_are_finite_and_never_negative(mesh, kind):
    weights = WEIGHTS[kind](mesh.points, mesh.triangles)
    assert np.isfinite(weights.data).all()
    assert (weights.data >= 0).all()
    assert not weights.diagonal().any()
    assert np.abs(laplacian(weights) @ np.ones(len(mesh.points))).max() < 1e-9 * max(weights.data.max(), 1)
    if kind != "mean value":
        assert np.abs((weights - weights.T).toarray()).max() <= 1e-9 * weights.data.max()


def test_the_cotangent_laplacian_is_the_dirichlet_energy():
    mesh, slope = sheet(9, 7), np.array([0.3, -0.7, 0.0])
    values = mesh.points @ slope
    energy = values @ laplacian(cotangent_weights(mesh.points, mesh.triangles)) @ values
    assert energy == pytest.approx(48 * (slope @ slope), rel=1e-3)  # clamped diagonals add a trifle
    assert masses(mesh.points, mesh.triangles).sum() == pytest.approx(48)


@pytest.mark.parametrize("kind", ["mean value", "cotangent", "intrinsic", "uniform"])
def test_inside_a_plane_linear_functions_are_harmonic(kind):
    mesh = sheet(9, 7)
    random = np.random.default_rng(0)
    points = mesh.points + 0.25 * random.uniform(-1, 1, mesh.points.shape) * [1, 1, 0] * (kind == "mean value")
    inner = np.flatnonzero((mesh.points[:, 0] % 8 > 0) & (mesh.points[:, 1] % 6 > 0))
    assert np.abs((normalized(WEIGHTS[kind](points, mesh.triangles)) @ points)[inner]).max() < 1e-9


@pytest.mark.parametrize("mesh", [tube(40, 14), tube(30, 16, bumps=0.2), sheet(25, 20)], ids=["tube", "bumps", "sheet"])
def test_eigenpairs_are_those_of_a_dense_solver(mesh):
    stiffness = laplacian(cotangent_weights(mesh.points, mesh.triangles))
    mass = masses(mesh.points, mesh.triangles)
    values, vectors = lowest_eigenpairs(stiffness, mass, 12)
    root = np.sqrt(mass)
    expected = np.linalg.eigvalsh((stiffness.toarray() / root) / root[:, None])[:12]
    assert np.abs(values - np.maximum(expected, 0)).max() < 1e-8 * expected[-1]
    assert np.abs(vectors.T @ (mass[:, None] * vectors) - np.eye(12)).max() < 1e-9
    residual = stiffness @ vectors - mass[:, None] * vectors * values
    assert np.linalg.norm(residual / root[:, None], axis=0).max() < 1e-8
    assert values[0] < 1e-8 < values[1]


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), rank=st.integers(0, 3), scale=st.sampled_from([1e-200, 1.0, 1e150]))
def test_the_nearest_rotation_maximises_the_trace(seed, rank, scale):
    random = np.random.default_rng(seed)
    one, two = random.normal(size=(2, 20, 3, max(rank, 1)))
    matrices = scale * (rank > 0) * one @ two.transpose(0, 2, 1)
    found = nearest_rotations(matrices)
    assert np.abs(found @ found.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12
    assert (np.linalg.det(found) > 0.5).all()
    u, s, v = np.linalg.svd(matrices / scale)
    best = s[:, 0] + s[:, 1] + s[:, 2] * np.sign(np.linalg.det(u @ v))
    assert np.abs((found * (matrices / scale)).sum(axis=(1, 2)) - best).max() < 1e-11 * max(1.0, s.max())


def test_rotation_vectors_turn_one_direction_into_the_other():
    random = np.random.default_rng(1)
    one, two = random.normal(size=(2, 100, 3))
    one[:5] = two[:5] * 1.7  # no turn
    one[5] = 0
    turned = np.einsum("nij,nj->ni", rotations_of(turning_vectors(one, two)), one)
    assert np.abs(turned[6:] / np.linalg.norm(one[6:], axis=1)[:, None]
                  - two[6:] / np.linalg.norm(two[6:], axis=1)[:, None]).max() < 1e-12  # fmt: skip
    assert np.abs(turned[:5] - one[:5]).max() < 1e-12
    assert not turning_vectors(one, two)[5].any()


def test_distances_in_a_plane_are_straight():
    mesh = sheet(25, 21)
    source = np.array([262])
    expected = np.linalg.norm(mesh.points - mesh.points[262], axis=1)
    distance = geodesic_distance(mesh.points, mesh.triangles, source)
    assert distance[262] == 0
    assert np.abs(distance - expected).max() < 0.08 * expected.max()
    apart = two_legs()
    assert np.isinf(geodesic_distance(apart.points, apart.triangles, np.array([0]))[apart.points[:, 0] > 2]).all()


def test_gradients_of_linear_maps_are_their_matrices():
    mesh, matrix = tube(), np.array([[1.2, 0.3, 0], [-0.1, 0.9, 0.2], [0.4, 0.2, 1]])
    slopes = plane_gradients(mesh.points, mesh.triangles) @ (mesh.points @ matrix.T)
    corners = mesh.points[mesh.triangles]
    sides = corners[:, 1] - corners[:, 0]
    moved = np.einsum("tji,tj->ti", slopes.reshape(-1, 3, 3), sides)
    assert np.abs(moved - sides @ matrix.T).max() < 1e-12
    turn = rotations_of(np.array([[0.3, 0.5, -0.2]]))[0]
    found = DeformationGradients(mesh.points, mesh.triangles)(mesh.points @ turn.T + 1.0)
    assert np.abs(found - turn).max() < 1e-10


def test_projection_is_the_closest_of_many_samples():
    random = np.random.default_rng(2)
    corners, queries = random.normal(size=(200, 3, 3)), random.normal(size=(200, 3)) * 2
    found = project(queries, corners)
    weights = random.dirichlet(np.ones(3) * 0.6, size=500)
    samples = np.einsum("sk,tki->tsi", weights, corners)
    nearest = np.linalg.norm(samples - queries[:, None], axis=2).min(axis=1)
    assert (np.linalg.norm(found - queries, axis=1) <= nearest + 1e-12).all()
    inside = np.linalg.lstsq(np.vstack([corners[0].T, np.ones(3)]), np.append(found[0], 1), rcond=None)[0]
    assert inside.min() > -1e-9  # it is a point of the triangle


def test_only_triangles_that_face_the_same_way_are_found():
    mesh = tube()
    search = FacingTriangles(mesh.points, mesh.triangles)
    outwards = np.array([[0.1, 0, 2.0]])
    _, right = search.closest(outwards, np.array([[1.0, 0, 0]]))
    _, left = search.closest(outwards, np.array([[-1.0, 0, 0]]))
    middle = mesh.points[mesh.triangles].mean(axis=1)
    assert middle[right[0], 0] > 0 > middle[left[0], 0] or left[0] == -1
