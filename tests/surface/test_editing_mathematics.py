"""What surface edits must give: rigid motions, reproduction, energies, agreement with dense references."""

from __future__ import annotations

import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import rotation, sheet, tube

from pliant.mesh import CornerValues, PolygonMesh
from pliant.numerics.meshes.laplacians import cotangent_weights, laplacian, masses
from pliant.surface.arap import ARAP
from pliant.surface.laplacian_edit import LaplacianEdit
from pliant.surface.skeleton_edit import SkeletonEdit

MESH = tube(bumps=0.15)
EVERYTHING = np.arange(len(MESH.points))
HEIGHT = MESH.points[:, 2]
ROI, HANDLE = np.flatnonzero(HEIGHT > 1.0), np.flatnonzero(HEIGHT > 3.3)


def dense_cotangents(points, triangles):
    """L = D - W straight from the definition, angle by angle."""
    matrix = np.zeros((len(points),) * 2)
    for triangle in triangles:
        for k in range(3):
            a, b, c = triangle[k], triangle[k - 2], triangle[k - 1]
            u, v = points[b] - points[a], points[c] - points[a]
            cotangent = (u @ v) / np.linalg.norm(np.cross(u, v)) / 2
            matrix[b, c] -= cotangent
            matrix[c, b] -= cotangent
    linked = matrix != 0
    matrix[linked] = np.minimum(matrix[linked], -1e-4)  # clamped, as it is documented
    return matrix - np.diag(matrix.sum(axis=1))


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_all_of_it_turns_with_a_handle_that_turns(seed):
    random = np.random.default_rng(seed)
    turn, offset = rotation(random.normal(size=3)), random.normal(size=3)
    bound = ARAP(EVERYTHING, HANDLE).bind(MESH)
    solution = bound.solve(bound.rest @ turn.T + offset)
    assert np.abs(solution.points - MESH.points @ turn.T - offset).max() < 1e-9
    assert solution.energy < 1e-18
    assert solution.status == "converged"


@pytest.mark.parametrize("weights", ["cotangent", "uniform", "intrinsic"])
@pytest.mark.parametrize("method", ["biharmonic", "naive", "similarity"])
def test_translations_are_reproduced(method, weights):
    bound = LaplacianEdit(EVERYTHING, HANDLE, method=method, weights=weights).bind(MESH)
    assert np.abs(bound.deform(bound.rest + [1, 2, 3]) - MESH.points - [1, 2, 3]).max() < 1e-6


def test_similarities_reproduce_scaling_and_small_turns():
    bound = LaplacianEdit(EVERYTHING, HANDLE, method="similarity").bind(MESH)
    spin = np.array([[0, -0.3, 0.1], [0.3, 0, -0.2], [-0.1, 0.2, 0]])  # the linearised turn is exact at any size
    matrix = 1.4 * np.eye(3) + spin
    assert np.abs(bound.deform(bound.rest @ matrix.T + 2.0) - MESH.points @ matrix.T - 2.0).max() < 1e-5


def test_linear_maps_of_a_plane_are_reproduced():
    mesh = sheet(12, 9)
    x, y, _ = mesh.points.T
    inner = np.flatnonzero((x > 1.5) & (x < 9.5) & (y > 1.5) & (y < 6.5))
    rim = np.setdiff1d(np.arange(len(mesh.points)), inner)
    matrix = np.array([[1.2, 0.3, 0], [-0.1, 0.9, 0], [0.4, 0.2, 1]])
    bound = LaplacianEdit(np.arange(len(mesh.points)), rim).bind(mesh)
    assert np.abs(bound.deform(bound.rest @ matrix.T + 1.0) - mesh.points @ matrix.T - 1.0).max() < 1e-8


def test_the_biharmonic_edit_is_the_dense_one():
    operator = dense_cotangents(MESH.points, MESH.triangles)
    assert np.abs(operator - laplacian(cotangent_weights(MESH.points, MESH.triangles)).toarray()).max() < 1e-10
    quadratic = operator @ np.diag(1 / masses(MESH.points, MESH.triangles)) @ operator
    bound = LaplacianEdit(ROI, HANDLE).bind(MESH)
    free, goal = bound.constraints.free, bound.rest + [0.5, 0.2, -0.3]
    right = -quadratic[np.ix_(free, HANDLE)] @ (goal - bound.rest)
    expected = MESH.points.copy()
    expected[HANDLE] = goal
    expected[free] += np.linalg.solve(quadratic[np.ix_(free, free)], right)
    assert np.abs(bound.deform(goal) - expected).max() < 1e-9


def test_the_naive_edit_is_the_dense_least_squares_solution():
    bound = LaplacianEdit(ROI, HANDLE, method="naive", weights="uniform", pull=3.0).bind(MESH)
    count, goal = len(MESH.points), bound.rest + [0.5, 0.2, -0.3]
    operator = np.eye(count)
    for vertex, around in enumerate(MESH.neighbors):
        operator[vertex, around] = -1 / len(around)
    drawn = 3.0 * np.eye(count)[HANDLE]
    system = np.vstack([operator, drawn])[:, ROI]
    fixed = np.setdiff1d(EVERYTHING, ROI)
    given = np.vstack([operator, drawn])[:, fixed] @ MESH.points[fixed]
    right = np.vstack([operator @ MESH.points, 3.0 * goal]) - given
    expected = MESH.points.copy()
    expected[ROI] = np.linalg.lstsq(system, right, rcond=None)[0]
    assert np.abs(bound.deform(goal) - expected).max() < 1e-8


def arap_energy(points, weights, rest):
    """Σ w |e' - R e|², each R by a singular value decomposition."""
    energy = 0.0
    for i in range(len(rest)):
        around, w = weights.indices[weights.indptr[i] : weights.indptr[i + 1]], weights[[i]].data
        before, after = rest[i] - rest[around], points[i] - points[around]
        u, _, v = np.linalg.svd((w[:, None] * after).T @ before)
        u[:, 2] *= np.linalg.det(u @ v)
        energy += (w[:, None] * (after - before @ (u @ v).T) ** 2).sum()
    return energy


@pytest.mark.parametrize("options", [{}, {"weights": "intrinsic"}, {"weights": "uniform"}, {"smoothness": 0.02}])
def test_the_energy_only_decreases(options):
    bound = ARAP(ROI, HANDLE, tolerance=0.0, iterations=60, **options).bind(MESH)
    goal = (bound.rest - [0, 0, 1.5]) @ rotation([1.5, 0.3, 0]).T + [0.2, 0, 1.5]
    solution = bound.solve(goal)
    assert (np.diff(solution.energies) <= 1e-12 * solution.energies[0]).all()
    assert solution.iterations <= 60
    assert solution.energy < solution.energies[0]
    assert np.array_equal(solution.points, bound.deform(goal))


def test_the_energy_is_what_it_is_called():
    bound = ARAP(ROI, HANDLE).bind(MESH)
    solution = bound.solve(bound.rest + [0.6, 0, -0.2])
    expected = arap_energy(solution.points, cotangent_weights(MESH.points, MESH.triangles), MESH.points)
    assert solution.energy == pytest.approx(expected, rel=1e-9)


def test_converged_cells_are_in_balance():
    bound = ARAP(ROI, HANDLE, tolerance=1e-13, iterations=20_000).bind(MESH)
    solution, step = bound.solve(bound.rest + [0.4, 0.1, -0.3]), 1e-5
    weights = cotangent_weights(MESH.points, MESH.triangles)
    for vertex in bound.constraints.free[::40]:
        for axis in range(3):
            ahead, behind = solution.points.copy(), solution.points.copy()
            ahead[vertex, axis] += step
            behind[vertex, axis] -= step
            slope = arap_energy(ahead, weights, MESH.points) - arap_energy(behind, weights, MESH.points)
            assert abs(slope / (2 * step)) < 1e-4  # the gradient of the energy vanishes


def test_stopping_early_is_a_status():
    bound = ARAP(ROI, HANDLE, tolerance=1e-12, iterations=2).bind(MESH)
    solution = bound.solve(bound.rest + [1.0, 0, -1.0])
    assert (solution.status, solution.iterations) == ("stopped", 2)


def test_a_drag_that_may_do_little_at_a_time_ends_where_one_that_may_do_all_does():
    bound = ARAP(ROI, HANDLE, tolerance=1e-9, iterations=5000).bind(MESH)
    goal, drag, energies = bound.rest + [0.5, 0, -0.2], bound.drag(), []
    drag.iterations = 3
    drag.resume(LaplacianEdit(ROI, HANDLE).bind(MESH).deform(goal))  # another method's result is where it begins
    while drag.solution is None or drag.solution.status == "stopped":
        drag.update(goal)
        energies += drag.solution.energies.tolist()
        assert drag.solution.iterations <= 3
    assert (np.diff(energies) <= 1e-9 * energies[0]).all()
    np.testing.assert_allclose(drag.points, bound.solve(goal).points, atol=1e-3)
    assert not len(drag.update(goal))  # there is nothing left to do


def test_weights_make_a_handle_strong():
    weak, strong = (
        LaplacianEdit(ROI, HANDLE, method="naive", pull=pull).bind(MESH).deform(MESH.points[HANDLE] + [1, 0, 0])[HANDLE]
        for pull in (0.05, np.linspace(50, 60, len(HANDLE)))
    )
    goal = MESH.points[HANDLE] + [1, 0, 0]
    assert np.abs(strong - goal).max() < 1e-2 < np.abs(weak - goal).max()


def test_a_straight_limb_turns_rigidly_with_its_skeleton():
    mesh = tube(60, 16)
    edge, held = np.flatnonzero(mesh.points[:, 2] > 1.0), np.flatnonzero(mesh.points[:, 2] > 3.4)
    bound = SkeletonEdit(edge, held, finish="none", contours=40, scalar="z").bind(mesh)
    pivot = mesh.points[bound.constraints.belt].mean(axis=0)
    turn = rotation([0.9, 0.2, 0])
    goal = (bound.rest - pivot) @ turn.T + pivot
    rigid = (mesh.points - pivot) @ turn.T + pivot
    beyond = np.flatnonzero(mesh.points[:, 2] > 2.2)
    assert np.abs(bound.deform(goal) - rigid)[beyond].max() < 0.05 * 4.0
    assert np.abs(bound.deform(goal) - rigid)[held].max() < 1e-9


def angles_about_z(before, after):
    """By how much each ring of sixteen has turned about z, in degrees, one after another."""
    turned = (after[:, 0] + 1j * after[:, 1]) / (before[:, 0] + 1j * before[:, 1])
    return np.degrees(np.unwrap(np.angle(turned.reshape(-1, 16).mean(axis=1))))


@pytest.mark.parametrize("choice", [{}, {"finish": "none"}, {"finish": "rigid"}, {"turning": "links"}])
@pytest.mark.parametrize("degrees", [90, -150])
def test_a_limb_that_is_turned_about_itself_is_twisted_evenly(choice, degrees):
    mesh = tube(60, 16)
    height = mesh.points[:, 2]
    roi, held = np.flatnonzero(height > 1.0), np.flatnonzero(height > 3.4)
    bound = SkeletonEdit(roi, held, **choice).bind(mesh)
    goal = bound.rest @ rotation([0, 0, np.radians(degrees)]).T
    moved = bound.deform(goal)
    assert np.abs(moved[held] - goal).max() < 1e-9  # the end goes along, all of it
    assert np.array_equal(moved[height < 1.0], mesh.points[height < 1.0])  # and the other stays
    rings = mesh.points[:960], moved[:960]
    evenly = np.clip((rings[0][::16, 2] - 1.0) / 2.4, 0, 1) * degrees
    assert np.abs(angles_about_z(*rings) - evenly).max() < 0.1 * abs(degrees)
    if choice.get("finish") != "rigid":  # which lets the cells have their way
        assert np.abs(np.hypot(*moved.T[:2]) - np.hypot(*mesh.points.T[:2])).max() < 1e-9
        assert np.abs(moved[:, 2] - height).max() < 1e-9


@pytest.mark.parametrize("finish", ["none", "smooth"])
def test_a_handle_follows_any_turn_about_the_joint(finish):
    mesh = tube(60, 16)
    roi, held = np.flatnonzero(mesh.points[:, 2] > 1.0), np.flatnonzero(mesh.points[:, 2] > 3.4)
    bound = SkeletonEdit(roi, held, finish=finish).bind(mesh)
    joint = mesh.points[bound.constraints.belt].mean(axis=0)
    for vector in ([0.9, 0.2, 0.0], [0.4, -0.7, 1.1], [0.0, 1.2, -2.0]):
        goal = (bound.rest - joint) @ rotation(vector).T + joint
        assert np.abs(bound.deform(goal)[held] - goal).max() < 1e-9


def test_what_is_only_carried_off_is_not_twisted():
    mesh = tube(60, 16, bumps=0.2)
    roi, held = np.flatnonzero(mesh.points[:, 2] > 1.0), np.flatnonzero(mesh.points[:, 2] > 3.4)
    bound = SkeletonEdit(roi, held).bind(mesh)
    shifted = bound.deform(bound.rest + [0.9, 0.4, -0.3])
    scaled = bound.rest.mean(axis=0) + 1.7 * (bound.rest - bound.rest.mean(axis=0)) + [0.9, 0.4, -0.3]
    assert np.abs(bound.deform(scaled) - shifted).max() < 1e-9
    single = SkeletonEdit(roi, held[-1:]).bind(mesh)  # one vertex tells of no turn
    assert np.isfinite(single.deform(single.rest + [0.5, 0, 0])).all()


def border_jump(mesh, points, belt):
    """The largest change of the angle between two faces, in degrees, among edges that touch a fixed edge."""
    corners = points[mesh.triangles], mesh.points[mesh.triangles]
    sides = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    pairs = order.reshape(-1, 2) // 3
    angles = []
    for triangle in corners:
        normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        angles.append(np.arccos(np.clip((normal[pairs[:, 0]] * normal[pairs[:, 1]]).sum(axis=1), -1, 1)))
    touching = np.isin(sides[order][::2], belt).any(axis=1)
    return np.degrees(np.abs(angles[0] - angles[1])[touching].max())


def test_a_large_turn_leaves_no_step_at_the_edge():
    mesh = tube(80, 20)
    roi, held = np.flatnonzero(mesh.points[:, 2] > 1.2), np.flatnonzero(mesh.points[:, 2] > 3.2)
    turn, jumps = rotation([np.radians(150), 0, 0]), {}
    for name, edit in {
        "plain": SkeletonEdit(roi, held, finish="none", profile=np.ones_like),
        "smooth": SkeletonEdit(roi, held),
        "bent": SkeletonEdit(roi, held, falloff="quadratic", turning="links"),
        "arap": ARAP(roi, held),
    }.items():
        bound = edit.bind(mesh)
        pivot = mesh.points[bound.constraints.belt].mean(axis=0)
        goal = (bound.rest - pivot) @ turn.T + pivot
        jumps[name] = border_jump(mesh, bound.deform(goal), bound.constraints.belt)
    assert jumps["plain"] > 120
    assert jumps["smooth"] < min(jumps["plain"], jumps["arap"])
    assert jumps["bent"] < 30


def test_stored_normals_are_computed_anew_where_faces_moved():
    mesh = MESH.replace(vertex_attributes={"normals": MESH.vertex_normals})
    moved = LaplacianEdit(ROI, HANDLE, goal=mesh.points[HANDLE] + [0.3, 0, 0])(mesh)
    normals = moved.vertex_attributes["normals"]
    assert np.allclose(normals, moved.vertex_normals, atol=1e-12)
    far = np.flatnonzero(HEIGHT < 0.7)
    assert np.array_equal(normals[far], mesh.vertex_attributes["normals"][far])


def test_sharp_edges_stay_sharp(box_mesh):
    turned = LaplacianEdit(np.arange(150), np.arange(150), goal=box_mesh.points @ rotation([0, 0, 0.5]).T)(box_mesh)
    assert isinstance(turned.normals, CornerValues)
    expected = box_mesh.normals.per_corner @ rotation([0, 0, 0.5]).T
    assert np.abs(turned.normals.per_corner - expected).max() < 1e-12


def test_an_unused_vertex_stays_and_a_handle_may_be_all():
    mesh = PolygonMesh(np.vstack([MESH.points, [[9.0, 9, 9]]]), MESH.faces)
    everything = np.arange(len(mesh.points))
    bound = ARAP(everything, HANDLE).bind(mesh)
    assert np.array_equal(bound.deform(bound.rest + 1)[-1], [9, 9, 9])
    goal = MESH.points * 2
    assert np.array_equal(ARAP(EVERYTHING, EVERYTHING, goal=goal)(MESH).points, goal)


def test_libigl_converges_to_the_same_shape():
    smooth = tube(bumps=0.0)
    height = smooth.points[:, 2]
    roi, handle = np.flatnonzero(height > 1.0), np.flatnonzero(height > 3.3)
    bound = ARAP(roi, handle, tolerance=1e-14, iterations=5000).bind(smooth)
    goal = bound.rest + [0.3, 0.1, -0.2]
    fixed = np.setdiff1d(np.arange(len(smooth.points)), bound.constraints.free)
    places = smooth.points.copy()
    places[handle] = goal
    data = igl.ARAPData()
    data.max_iter, data.energy = 5000, igl.ARAPEnergyType.ARAP_ENERGY_TYPE_SPOKES
    igl.arap_precomputation(smooth.points, smooth.triangles.astype(np.int64), 3, fixed.astype(np.int32), data)
    theirs = igl.arap_solve(np.ascontiguousarray(places[fixed]), data, smooth.points.copy())
    assert np.abs(theirs - bound.deform(goal)).max() < 1e-3  # across right angles weights are 1e-4 here, 0 there
