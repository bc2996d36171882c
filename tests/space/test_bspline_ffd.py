import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.errors import InvalidControls, InvalidDeformer, InvalidMesh, InvalidTarget, NotConverged
from pliant.space.bspline_ffd import BSplineFFD
from pliant.testing import check_deformer


def turned(angle=0.7):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def bent(points, shape=(6, 5, 4), edge="clamp", size=0.05, axes=None, seed=3):
    lattice = BSplineFFD.around(points, shape=shape, edge=edge, axes=axes)
    return lattice.moved(lattice.rest + np.random.default_rng(seed).normal(size=lattice.rest.shape) * size)


def naive(ffd, points):
    """The 64-term sum, one point and one control point at a time (Lee, Wolberg & Shin 1997, eq. 1)."""

    def basis(i, u):
        return [(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3][i] / 6

    def value(index):
        if ffd.edge == "zero" and any(not 0 <= i < n for i, n in zip(index, ffd.shape, strict=True) if n > 1):
            return np.zeros(3)
        return ffd.displacements[tuple(np.clip(i, 0, n - 1) for i, n in zip(index, ffd.shape, strict=True))]

    result = []
    for x in points:
        q = ffd.axes.T @ (x - ffd.origin) / ffd.spacing
        cell = np.floor(q).astype(int)
        u = q - cell
        moved = ffd.affine[:3, :3] @ x + ffd.affine[:3, 3]
        for reach in itertools.product(range(4), repeat=3):
            weight = np.prod([basis(r, t) for r, t in zip(reach, u, strict=True)])
            moved = moved + weight * value(cell - 1 + np.array(reach))
        result.append(moved)
    return np.array(result)


@pytest.mark.parametrize("edge", ["clamp", "zero"])
@pytest.mark.parametrize("shape", [(6, 5, 4), (2, 3, 9), (4, 5, 1), (1, 1, 1)])
def test_laws(random, edge, shape):
    points = random.random((300, 3)) * [2, 3, 1]
    check_deformer(bent(points, shape, edge), points)


def test_laws_on_a_mesh_with_corner_normals(box_mesh):
    check_deformer(bent(box_mesh, axes=turned()), box_mesh)


def test_laws_with_an_affine_part(random):
    points = random.random((200, 3))
    affine = np.eye(4)
    affine[:3] += random.normal(size=(3, 4)) * 0.1
    ffd = BSplineFFD(
        displacements=random.normal(size=(4, 4, 4, 3)) * 0.02,
        origin=np.zeros(3),
        spacing=np.full(3, 0.4),
        affine=affine,
    )
    check_deformer(ffd, points, rest_image=points @ affine[:3, :3].T + affine[:3, 3])


@pytest.mark.parametrize("edge", ["clamp", "zero"])
def test_agrees_with_the_naive_sum_far_beyond_the_lattice_too(random, edge):
    ffd = bent(random.random((50, 3)) * [2, 3, 1], edge=edge, axes=turned(), size=0.2)
    points = random.random((120, 3)) * [8, 12, 4] - [3, 4.5, 1.5]
    points = np.vstack([points, ffd.rest.reshape(-1, 3)[::7]])  # and exactly on control points
    assert np.abs(ffd(points) - naive(ffd, points)).max() < 1e-13


def test_clamp_reproduces_translations_everywhere(random):
    lattice = BSplineFFD.around(random.random((10, 3)), shape=(4, 3, 2))
    points = random.normal(size=(500, 3)) * 10
    assert np.abs(lattice.moved(lattice.rest + [1, 2, 3])(points) - points - [1, 2, 3]).max() < 1e-13


def test_zero_leaves_distant_points_exactly_alone(random):
    ffd = bent(random.random((50, 3)), edge="zero", size=1.0)
    far = random.normal(size=(300, 3))
    far = 20 * far / np.linalg.norm(far, axis=1, keepdims=True)
    assert np.array_equal(ffd(far), far)


def test_linear_fields_are_reproduced_inside(random):
    lattice = BSplineFFD.around(random.random((50, 3)), shape=(7, 7, 7))
    matrix = random.normal(size=(3, 3)) * 0.1
    ffd = lattice.moved(lattice.rest + lattice.rest @ matrix.T)
    inside = lattice.origin + lattice.spacing * (1 + 4 * random.random((200, 3)))
    assert np.abs(ffd(inside) - inside - inside @ matrix.T).max() < 1e-14


def test_control_points_span_the_box_and_its_corners_move(random):
    points = random.random((100, 3)) * [2, 3, 1] - 5
    lattice = BSplineFFD.around(points, shape=(4, 5, 6))
    assert np.allclose(lattice.rest[0, 0, 0], points.min(axis=0), rtol=0, atol=1e-14)
    assert np.allclose(lattice.rest[-1, -1, -1], points.max(axis=0), rtol=0, atol=1e-14)
    corner = points.max(axis=0)[None]
    controls = lattice.rest.copy()
    controls[-1, -1, -1] += 1.0
    assert (lattice.moved(controls)(corner) - corner > 0.5).all()  # (5/6)^3 of it: a clamped corner
    grown = BSplineFFD.around(points, shape=(4, 5, 6), margin=0.1)
    assert np.allclose(grown.rest[0, 0, 0], points.min(axis=0) - 0.1 * np.ptp(points, axis=0))


@settings(max_examples=25, deadline=None)
@given(
    shape=st.tuples(*[st.integers(1, 6)] * 3),
    edge=st.sampled_from(["clamp", "zero"]),
    angle=st.floats(0, 6),
    seed=st.integers(0, 9),
)
def test_refinement_is_exact_everywhere(shape, edge, angle, seed):
    random = np.random.default_rng(seed)
    ffd = bent(random.random((20, 3)), shape, edge, size=0.3, axes=turned(angle), seed=seed)
    points = random.random((200, 3)) * 4 - 1.5
    fine = ffd.refined()
    assert np.abs(fine(points) - ffd(points)).max() < 1e-13
    assert np.abs(fine.refined()(points) - ffd(points)).max() < 1e-13
    assert all(
        f == 1 if n == 1 else np.isclose(s, h / 2)
        for f, n, s, h in zip(fine.shape, ffd.shape, fine.spacing, ffd.spacing, strict=True)
    )


def test_a_planar_lattice_maps_the_plane_into_space(random):
    flat = np.column_stack([random.random((80, 2)), np.zeros(80)])
    lattice = BSplineFFD.around(flat, shape=(5, 5, 1))
    controls = lattice.rest.copy()
    controls[2, 2, 0, 2] += 1.0
    lifted = lattice.moved(controls)(flat)
    assert np.array_equal(lifted[:, :2], flat[:, :2])
    assert 0.3 < lifted[:, 2].max() <= (2 / 3) ** 2
    raised = flat + [0, 0, 7.0]  # constant along the axis that has one control point
    assert np.allclose(lattice.moved(controls)(raised), lifted + [0, 0, 7.0])
    thick = BSplineFFD.around(flat, shape=(3, 3, 3))  # a flat shape in a lattice with layers above and below
    assert np.allclose(thick.rest[:, :, 1, 2], 0)


def test_drag_touches_only_the_support(random):
    points = random.random((4000, 3))
    lattice = BSplineFFD.around(points, shape=(9, 9, 9))
    drag = lattice.bind(points).drag(lattice.rest)
    controls = lattice.rest.copy()
    controls[4, 4, 4] += 0.1
    touched = drag.update(controls, changed=[(4, 4, 4)])
    near = (np.abs(points - lattice.rest[4, 4, 4]) < 2 * lattice.spacing).all(axis=1)
    assert np.array_equal(np.sort(touched), np.flatnonzero(near))
    assert np.array_equal(drag.points[~near], points[~near])


def test_a_long_drag_does_not_drift(random):
    points = random.random((500, 3))
    lattice = BSplineFFD.around(points, shape=(5, 5, 5))
    binding = lattice.bind(points)
    drag, controls = binding.drag(), lattice.rest.copy()
    for step in random.normal(size=(300, 3)) * 0.1:
        controls[2, 2, 2] += step
        drag.update(controls, changed=[(2, 2, 2)])
    assert np.abs(drag.points - binding.deform(controls)).max() < 1e-13


def test_inverse_and_fold(random):
    points = random.random((300, 3))
    ffd = bent(points, size=0.03)
    assert np.abs(ffd.inverse(ffd(points)) - points).max() < 1e-9
    folded = dataclasses.replace(ffd, affine=np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(NotConverged, match="folds"):
        folded.inverse(folded(points))


def test_normals_are_carried_by_the_cofactor_matrix(box_mesh):
    ffd = bent(box_mesh, size=0.1)
    moved = ffd(box_mesh)
    jacobian = ffd.jacobian(box_mesh.points)
    corner = 17
    vertex = box_mesh.faces.flat[corner]
    expected = np.linalg.det(jacobian[vertex]) * np.linalg.inv(jacobian[vertex]).T @ box_mesh.normals.per_corner[corner]
    assert np.allclose(moved.normals.per_corner[corner], expected / np.linalg.norm(expected))
    assert moved.uvs is box_mesh.uvs
    assert moved.groups is box_mesh.groups


def test_sparse_weights_are_the_operator(random):
    points = random.random((60, 3)) * 3 - 1
    binding = bent(points, edge="zero").bind(points)
    assert np.allclose(binding.matrix().toarray(), binding.weights @ np.eye(binding.weights.shape[1]), atol=1e-15)


def test_errors_name_cause_and_cure(random):
    points = random.random((20, 3))
    lattice = BSplineFFD.around(points)
    with pytest.raises(InvalidControls, match=r"shape \(2, 2\); this deformer's have \(4, 4, 4, 3\)"):
        lattice.moved(np.zeros((2, 2)))
    controls = lattice.rest.copy()
    controls[1, 2, 3, 0] = np.nan
    with pytest.raises(InvalidControls, match=r"control \(1, 2, 3, 0\) is nan"):
        lattice.bind(points).deform(controls)
    with pytest.raises(InvalidControls, match="not in a lattice"):
        lattice.bind(points).drag().update(lattice.rest, changed=[(0, 0, 9)])
    with pytest.raises(InvalidMesh, match="1 of 2 points are not finite, the first is point 1"):
        lattice(np.array([[0, 0, 0], [np.inf, 0, 0]]))
    with pytest.raises(InvalidTarget, match="without points"):
        BSplineFFD.around(np.empty((0, 3)))
    with pytest.raises(InvalidDeformer, match="spacing must be positive"):
        BSplineFFD(displacements=np.zeros((2, 2, 2, 3)), origin=np.zeros(3), spacing=np.array([1, 0, 1.0]))
    with pytest.raises(InvalidDeformer, match="orthonormal"):
        BSplineFFD.around(points, axes=np.ones((3, 3)))
    with pytest.raises(InvalidDeformer, match="singular"):
        BSplineFFD(
            displacements=np.zeros((2, 2, 2, 3)),
            origin=np.zeros(3),
            spacing=np.ones(3),
            affine=np.diag([1.0, 0, 1, 1]),
        )
