"""Cages: identities of the coordinates, agreement with plain versions, the cage itself and what lies beyond."""

from __future__ import annotations

import numpy as np
import pytest
from cage_shapes import ball, box, dented, plain_green, plain_mean_values
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.deformer import LinearBinding
from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.mesh import PolygonMesh
from pliant.space.cage import Cage
from pliant.testing import check_deformer

RANDOM = np.random.default_rng(5)
INSIDE = RANDOM.uniform(-0.45, 0.45, (120, 3))
EVERYWHERE = RANDOM.normal(size=(150, 3))
KINDS = ("mean_value", "green", "harmonic", "maximum_entropy", "quad_mean_value", "quad_green")
AFFINE = ("mean_value", "harmonic", "maximum_entropy", "quad_mean_value")
LINEAR = RANDOM.normal(size=(3, 3))
TURN = np.linalg.qr(LINEAR)[0] * np.sign(np.linalg.det(np.linalg.qr(LINEAR)[0]))


def inside_of(cage, count=60):
    points = np.random.default_rng(1).uniform(-1, 1, (30 * count, 3))
    return points[Cage(cage)._scheme.places(points) == 1][:count]


def moved(cage, kind, **more):
    change = 0.1 * np.random.default_rng(2).normal(size=cage.points.shape)
    return Cage(cage, coordinates=kind, positions=cage.points + change, **more)


def table(cage, kind, points, **more):
    binding = Cage(cage, coordinates=kind, **more).bind(points)
    return (binding.table if isinstance(binding, LinearBinding) else binding.tables[0]).matrix


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("cage", [ball(), box()], ids=["ball", "box"])
def test_obeys_the_laws_of_deformers(kind, cage):
    check_deformer(moved(cage, kind), INSIDE)


@pytest.mark.parametrize("kind", KINDS)
def test_obeys_them_outside_too(kind):
    deformer = moved(ball(), kind)
    derivative = deformer.jacobian(EVERYWHERE)
    h = 1e-6
    for axis in range(3):
        step = h * np.eye(3)[axis]
        slope = (deformer(EVERYWHERE + step) - deformer(EVERYWHERE - step)) / (2 * h)
        assert np.abs(slope - derivative[:, :, axis]).max() < 1e-6


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("cage", [ball(), box(), dented()], ids=["ball", "box", "dented"])
def test_weights_add_up_to_one_and_give_back_the_point(kind, cage):
    points = inside_of(cage)
    binding = Cage(cage, coordinates=kind).bind(points)
    assert np.abs(table(cage, kind, points).sum(axis=1) - 1).max() < 1e-14
    if kind in AFFINE:
        goal = points @ LINEAR + [1, 2, 3]
        assert np.abs(binding.deform(cage.points @ LINEAR + [1, 2, 3]) - goal).max() < 1e-11
    goal = 2 * points @ TURN + [1, 2, 3]
    assert np.abs(binding.deform(2 * cage.points @ TURN + [1, 2, 3]) - goal).max() < 1e-11


def test_green_coordinates_do_not_reproduce_what_is_no_similarity():
    cage = ball()
    stretch = [2.0, 1.0, 1.0]
    found = Cage(cage, coordinates="green").bind(INSIDE).deform(cage.points * stretch)
    assert np.abs(found - INSIDE * stretch).max() > 0.05


def test_mean_values_agree_with_extended_precision():
    cage = ball(2, 0.2)
    points = np.vstack([INSIDE[:12], EVERYWHERE[:12]])
    expected = np.array([plain_mean_values(cage, point) for point in points])
    assert np.abs(table(cage, "mean_value", points) - expected).max() < 1e-12


def test_green_coordinates_agree_with_quadrature():
    cage = ball(1, 0.2)
    binding = Cage(cage, coordinates="green").bind(INSIDE[:6])
    for row, point in enumerate(INSIDE[:6]):
        phi, psi = plain_green(cage, point)
        assert np.abs(binding.tables[0].matrix[row] - phi).max() < 1e-9
        assert np.abs(binding.tables[1].matrix[row] - psi).max() < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_approaches_to_a_face_an_edge_and_a_vertex(kind):
    cage = ball(1, 0.15)
    corners = cage.points[cage.triangles[3]]
    inwards = -corners.mean(axis=0) / np.linalg.norm(corners.mean(axis=0))
    shares = np.array([[0.2, 0.3, 0.5], [0.4, 0.6, 0.0], [1.0, 0.0, 0.0]])
    for share in shares:
        foot = share @ corners
        steps = 10.0 ** -np.arange(2, 17)
        points = foot + steps[:, None] * inwards
        binding = Cage(cage, coordinates=kind).bind(points)
        rows = table(cage, kind, points)
        assert np.abs(rows.sum(axis=1) - 1).max() < 1e-13
        if kind in AFFINE:
            assert np.abs(binding.deform(cage.points @ LINEAR) - points @ LINEAR).max() < 3e-7  # snapped below 1e-7
            if kind != "maximum_entropy":
                assert np.abs(binding.deform(cage.points @ LINEAR) - points @ LINEAR).max() < 1e-8
        goal = points @ TURN
        assert np.abs(binding.deform(cage.points @ TURN) - goal).max() < 3e-7
        if not kind.endswith("green"):
            expected = np.zeros(len(cage.points))
            expected[cage.triangles[3]] = share
            distance = np.abs(rows - expected).max(axis=1)
            slack = 0.1 if kind == "harmonic" else 0.0  # boundary elements meet the values on edges on average
            assert (distance < 60 * np.maximum(steps, 1e-12) ** 0.5 + slack).all()
            assert distance[-1] < 1e-6


def test_mean_values_stay_exact_down_to_the_surface():
    cage = ball(1, 0.15)
    corners = cage.points[cage.triangles[5]]
    inwards = -corners.mean(axis=0)
    for share in ([0.2, 0.3, 0.5], [0.4, 0.6, 0.0], [1.0, 0.0, 0.0]):
        points = share @ corners + np.outer(10.0 ** -np.arange(1, 14), inwards)
        weights = table(cage, "mean_value", points)
        assert np.abs(weights @ cage.points - points).max() < 3e-15
        expected = np.array([plain_mean_values(cage, point) for point in points[:7]])
        assert np.abs(weights[:7] - expected).max() < 1e-9  # positions are themselves rounded by 1e-16


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 10_000), st.sampled_from([1e-3, 1.0, 1e5]), st.sampled_from([0.0, 1e2]))
def test_size_and_place_do_not_matter(seed, size, offset):
    cage = ball(1, 0.2, seed)
    points = np.random.default_rng(seed).uniform(-0.4, 0.4, (20, 3))
    other = cage.with_points(size * (cage.points + offset))
    for kind in ("mean_value", "green"):
        one, two = table(cage, kind, points), table(other, kind, size * (points + offset))
        assert np.abs(one - two).max() < 1e-10


def test_far_away_mean_values_still_add_up():
    cage = ball(2, 0.1)
    for distance in (1e1, 1e2, 1e3):
        points = distance * EVERYWHERE[:40]
        weights = table(cage, "mean_value", points)
        assert np.abs(weights.sum(axis=1) - 1).max() < 1e-9
        assert np.abs(weights @ cage.points - points).max() < 1e-13 * distance**2


def test_green_weights_tell_inside_from_outside():
    cage = ball(1, 0.1)
    deformer = Cage(cage, coordinates="green")
    distance = np.linalg.norm(EVERYWHERE, axis=1)
    places = deformer._scheme.places(EVERYWHERE)
    assert (places[distance < 0.7] == 1).all()
    assert (places[distance > 1.2] == -1).all()


def test_mean_values_tell_inside_from_outside():
    cage = dented()
    deformer = Cage(cage)
    points = np.array([[0.8, 0, 0.0], [0, 0, 0.0], [0, 0, -0.9], [3, 0, 0], cage.points[2]])
    assert deformer._scheme.places(points).tolist() == [1, -1, 1, -1, 0]


def test_harmonic_coordinates_converge_on_a_harmonic_function():
    # x² - y² on the surface of a box, interpolated by the box cut finer and finer
    errors = []
    for cells in (2, 4, 8):
        cage = fine_box(cells)
        x, y, _ = cage.points.T
        weights = table(cage, "harmonic", INSIDE, levels=0)
        errors.append(np.abs(weights @ (x**2 - y**2) - (INSIDE[:, 0] ** 2 - INSIDE[:, 1] ** 2)).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 1.6).all()


def test_harmonic_weights_are_nearly_positive_the_finer_the_more():
    least = [table(dented(), "harmonic", inside_of(dented()), levels=level).min() for level in (0, 1, 2)]
    assert least[0] < least[2] + 1e-3
    assert least[2] > -0.003


def test_maximum_entropy_weights_are_never_negative():
    cage = dented()
    points = inside_of(cage)
    assert table(cage, "maximum_entropy", points).min() >= 0
    assert table(cage, "mean_value", points).min() < 0


@pytest.mark.parametrize("kind", ["quad_mean_value", "quad_green", "harmonic"])
def test_quadrangles_have_no_preferred_diagonal(kind):
    cage = box()
    turned = PolygonMesh(cage.points, [np.roll(face, 1) for face in cage.faces])
    if kind == "harmonic":
        assert np.abs(table(cage, kind, INSIDE) - table(turned, kind, INSIDE)).max() > 1e-3  # it cuts into triangles
    else:
        assert np.abs(table(cage, kind, INSIDE) - table(turned, kind, INSIDE)).max() < 1e-14
        quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
        order = np.abs((cage.points @ quarter)[:, None] - cage.points).sum(axis=2).argmin(axis=1)
        one, two = table(cage, kind, INSIDE), table(cage, kind, INSIDE @ quarter)
        assert np.abs(two[:, order] - one).max() < 1e-14


def test_finer_quadrangles_converge():
    cage = box().with_points(box().points + 0.2 * np.random.default_rng(0).normal(size=(8, 3)))
    finest = table(cage, "quad_mean_value", INSIDE, levels=3)
    errors = [np.abs(table(cage, "quad_mean_value", INSIDE, levels=k) - finest).max() for k in (0, 1, 2)]
    assert errors[0] > 3 * errors[1] > 9 * errors[2] > 0


def test_points_outside_are_extended_kept_or_refused():
    cage = ball()
    points = np.array([[0, 0, 0.0], [0, 0, 3.0]])
    for kind in KINDS:
        shifted = cage.points + [1, 0, 0]
        assert np.allclose(Cage(cage, coordinates=kind, positions=shifted)(points), points + [1, 0, 0])
        kept = Cage(cage, coordinates=kind, positions=shifted, outside="keep")
        assert np.allclose(kept(points), [[1, 0, 0], [0, 0, 3]])
        assert np.array_equal(kept.jacobian(points)[1], np.eye(3))
        with pytest.raises(OutsideDomain, match="1 of 2 points are outside the cage, the first is point 1"):
            Cage(cage, coordinates=kind, outside="refuse").bind(points)


def test_points_on_the_cage_follow_it():
    cage = ball()
    for kind in ("mean_value", "harmonic", "maximum_entropy", "quad_mean_value"):
        deformer = moved(cage, kind)
        assert np.allclose(deformer(cage.points), deformer.controls, atol=1e-12)
        middles = cage.points[cage.triangles].mean(axis=1)
        assert np.allclose(deformer(middles), deformer.controls[cage.triangles].mean(axis=1), atol=1e-7)


@pytest.mark.parametrize("kind", ["mean_value", "green"])
def test_weights_may_be_kept_in_single_precision_or_sparse(kind):
    cage = ball(2)
    goal = moved(cage, kind).bind(INSIDE).deform()
    single = moved(cage, kind, precision="float32").bind(INSIDE)
    assert 0 < np.abs(single.deform() - goal).max() < 1e-6
    sparse = moved(cage, kind, threshold=1e-2).bind(INSIDE)
    matrix = (sparse.table if kind == "mean_value" else sparse.tables[0]).matrix
    assert matrix.nnz < 0.95 * np.prod(matrix.shape)
    assert np.abs(matrix.sum(axis=1) - 1).max() < 1e-12
    assert np.abs(sparse.deform() - goal).max() < 0.05
    for binding in (single, sparse):
        drag, controls = binding.drag(), binding.controls.copy()
        controls[3] += 0.1
        drag.update(controls, changed=[(3,)])
        assert np.abs(drag.points - binding.deform(controls)).max() < 1e-12


def fine_box(cells):
    from pliant.cages.boxes import cage_from_box

    return cage_from_box(PolygonMesh(box().points * 0.5, box().faces), cells=(cells,) * 3, margin=0.5 / np.sqrt(3))


def broken():
    cage = ball()
    faces = cage.triangles
    crossed = cage.points.copy()
    crossed[2] = [0, 0, -3]
    flat = cage.points.copy()
    flat[faces[0][0]] = flat[faces[0][1]]
    return [
        (PolygonMesh(cage.points, faces[1:]), "open: 3 edges have one face only"),
        (PolygonMesh(cage.points, faces[:, ::-1]), "inside out"),
        (PolygonMesh(cage.points, np.vstack([faces[1:], faces[:1, ::-1]])), "oriented against each other"),
        (PolygonMesh(crossed, faces), "cuts itself: .* pairs of triangles do, the first are of faces"),
        (PolygonMesh(flat, faces), "have no area, the first is of face"),
        (PolygonMesh(cage.points), "no faces"),
    ]


@pytest.mark.parametrize(("mesh", "message"), broken())
def test_bad_cages_are_named(mesh, message):
    with pytest.raises(InvalidDeformer, match=message):
        Cage(mesh)


@pytest.mark.parametrize(
    "options",
    [{"coordinates": "magic"}, {"outside": "?"}, {"levels": 7}, {"precision": "int8"}, {"threshold": 1.0}],
)
def test_bad_options_are_named(options):
    with pytest.raises(InvalidDeformer, match="it must be"):
        Cage(box(), **options)
