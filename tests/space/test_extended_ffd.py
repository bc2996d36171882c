import numpy as np
import pytest

from pliant.errors import InvalidDeformer, InvalidTarget, OutsideDomain
from pliant.numerics.lattices.patch_block import PatchBlock
from pliant.space.extended_ffd import ExtendedFFD
from pliant.space.lattice_merge import merge
from pliant.space.round_lattices import ring_radius
from pliant.testing import check_deformer

SIZE = np.array([2.0, 1.0, 3.0])
MAKERS = {
    "cylinder": lambda points, **options: ExtendedFFD.cylinder(points, **options),
    "fine cylinder": lambda points, **options: ExtendedFFD.cylinder(points, axis="y", shape=(5, 7, 10), **options),
    "prism": lambda points, **options: ExtendedFFD.prism(points, axis="x", **options),
    "triangular prism": lambda points, **options: ExtendedFFD.prism(points, sides=3, shape=(7, 4), **options),
    "sphere": lambda points, **options: ExtendedFFD.sphere(points, **options),
    "coarse sphere": lambda points, **options: ExtendedFFD.sphere(points, shape=(6, 4, 4), **options),
}


def cloud(count=300, seed=0):
    return np.random.default_rng(seed).random((count, 3)) * SIZE


def displaced(deformer, size=0.03, seed=1):
    return deformer.moved(deformer.rest + np.random.default_rng(seed).normal(size=deformer.rest.shape) * size)


def box(low, high, shape=(4, 4, 4)):
    """A Bézier box as a lattice of its own."""
    steps = [np.linspace(a, b, n) for a, b, n in zip(low, high, shape, strict=True)]
    points = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    block = PatchBlock(np.arange(len(points)).reshape(shape), ("bezier",) * 3, (False,) * 3)
    return ExtendedFFD(points=points, blocks=(block,))


def naive(ffd, parameters):
    """Image of (3,) parameters of a block: the tensor product term by term, Cox and de Boor's recursion."""
    block = ffd.blocks[0]

    def function(knots, i, degree, t):
        if degree == 0:
            return float(knots[i] <= t < knots[i + 1])
        left, right = knots[i + degree] - knots[i], knots[i + degree + 1] - knots[i + 1]
        first = (t - knots[i]) / left * function(knots, i, degree - 1, t) if left else 0.0
        return first + ((knots[i + degree + 1] - t) / right * function(knots, i + 1, degree - 1, t) if right else 0.0)

    factors = []
    for axis in range(3):
        count, t = block.index.shape[axis], parameters[axis]
        if block.bases[axis] == "bspline":
            knots = np.arange(-4 - count, 2 * count + 5)  # function i peaks at knots[i + 2]
            values = np.zeros(count)
            for i in range(len(knots) - 4):
                values[(knots[i] + 2) % count] += function(knots, i, 3, t)
        else:
            patches = -(-count // 3) if block.wrapped[axis] else count // 3
            knots = np.concatenate([[0], np.repeat(np.arange(patches + 1), 3), [patches]])
            values = np.zeros(count)
            for i in range(len(knots) - 4):
                values[i % count] += function(knots, i, 3, t)
        factors.append(values)
    return np.einsum("i,j,k,ijkc->c", *factors, ffd.controls[block.index])


@pytest.mark.parametrize("name", MAKERS)
def test_laws(name):
    ffd = displaced(MAKERS[name](cloud()))

    def smooth(points):  # Bézier patches meet in kinks when control points move anyhow
        parameters, inside = ffd.blocks[0].parameters(ffd.rest, points)
        joint = np.abs(parameters - np.round(parameters)) < 2e-3
        joint &= np.array([basis == "bezier" for basis in ffd.blocks[0].bases])
        result = np.ones(len(points), bool)
        result[inside] = ~joint.any(axis=1)
        return result

    assert smooth(cloud()).mean() > 0.8
    check_deformer(ffd, cloud(), smooth=smooth)


@pytest.mark.parametrize("name", MAKERS)
def test_the_wrapped_shape_is_inside(name):
    corners = np.stack(np.meshgrid(*([0, s] for s in SIZE), indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.concatenate([cloud(2000), corners])
    for margin in (0.0, 0.05):
        binding = MAKERS[name](points, margin=margin, outside="error").bind(points)
        weights = binding.matrix()
        assert len(binding.outside) == 0
        assert np.abs(weights.sum(axis=1) - 1).max() < 1e-13
        assert np.abs(weights @ binding.rest - points).max() < 1e-12
        assert np.diff(weights.indptr).max() <= 64


@pytest.mark.parametrize("name", MAKERS)
def test_agrees_with_the_tensor_product_term_by_term(name, random):
    ffd = displaced(MAKERS[name](cloud()))
    parameters = random.random((12, 3)) * ffd.blocks[0].cells
    rest = ffd.moved(ffd.rest)
    points = np.array([naive(rest, q) for q in parameters])
    expected = np.array([naive(ffd, q) for q in parameters])
    assert np.abs(ffd(points) - expected).max() < 1e-11


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize("radius", [0.1, 1e-3, 1e-6, 1e-9, 0.0])
def test_every_point_near_the_axis_is_found_within_few_steps(name, radius, random, monkeypatch):
    from pliant.numerics.lattices import hyperpatch

    ffd, steps, invert = MAKERS[name](cloud(), outside="error"), [], hyperpatch.invert
    monkeypatch.setattr(hyperpatch, "invert", lambda *a: (invert(*a), steps.append(a[-1][a[1] : a[2]].max())))
    frame, angle = ffd.frames[0], random.random(300) * 2 * np.pi
    local = np.stack([radius * np.cos(angle), radius * np.sin(angle), random.uniform(-0.9, 0.9, 300)], axis=1)
    points = frame.center + local @ frame.axes.T
    ffd.bind(points)
    assert max(steps) <= (4 if "sphere" in name else 3)
    moved = displaced(ffd)
    assert np.isfinite(moved.jacobian(points)).all()
    near = moved(points) - moved(
        np.repeat(points[:1], 300, axis=0) * 0 + frame.center + (local * [0, 0, 1]) @ frame.axes.T
    )
    assert np.linalg.norm(near, axis=1).max() <= 3 * radius * np.abs(frame.axes).max() + 1e-12


def test_points_outside_stay_and_are_named():
    points = np.concatenate([cloud(), cloud(7) + [0, 0, 9]])
    for edited in (False, True):
        ffd = ExtendedFFD.cylinder(cloud())
        if edited:
            ffd = ffd.with_rest(ffd.rest)
        moved = ffd.moved(ffd.rest + [0.5, 0, 0])
        binding = moved.bind(points)
        assert np.array_equal(binding.outside, np.arange(300, 307))
        assert np.array_equal(moved(points)[300:], points[300:])
        assert np.abs(moved(points)[:300] - points[:300] - [0.5, 0, 0]).max() < 1e-13
    with pytest.raises(OutsideDomain, match="does not contain 7 of 307 points, the first is point 300"):
        ExtendedFFD.cylinder(cloud(), outside="error")(points)


@pytest.mark.parametrize("name", MAKERS)
def test_edited_lattices_find_all_their_points(name, random):
    ffd = MAKERS[name](cloud(), outside="error", margin=0.25)
    low, high = ffd.rest.min(axis=0), ffd.rest.max(axis=0)

    def bend(x):
        t = (x - low) / (high - low)
        return x + 0.15 * np.sin(2 * t[:, [1, 2, 0]])

    edited = ffd.with_rest(bend(ffd.rest))
    parameters = random.uniform(0.02, 0.98, (400, 3)) * ffd.blocks[0].cells
    points, _ = edited.blocks[0].differentiate(edited.rest, parameters)
    weights = edited.bind(points).matrix()
    assert np.abs(weights @ edited.rest - points).max() < 1e-8
    expected, _ = ffd.blocks[0].differentiate(edited.rest * 1.1, parameters)
    assert np.abs(edited.moved(edited.rest * 1.1)(points) - expected).max() < 1e-7


@pytest.mark.parametrize("count", [5, 8, 12])
def test_rings_are_as_wide_as_they_say(count, random):
    frame_turns = random.random(50) * count
    ring = np.exp(2j * np.pi * np.arange(count) / count)
    cell, t = np.floor(frame_turns).astype(int), np.mod(frame_turns, 1)
    weights = [(1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6]
    places = sum(w * ring[(cell + k) % count] for k, w in enumerate(weights, start=-1))
    assert np.abs(np.abs(places) - ring_radius(count, frame_turns)).max() < 1e-14
    assert ring_radius(8).min() == pytest.approx(0.901, abs=5e-4)


def jumps(ffd, joint, aside):
    """Largest jump of the Jacobian from one side of points to the other."""
    return np.abs(ffd.jacobian(joint - aside) - ffd.jacobian(joint + aside)).max()


def test_smooth_moves_keep_joints_c1_inside_a_block_and_across_a_weld(random):
    one, two = box([0, 0, 0], [1, 1, 1], (7, 4, 4)), box([1, 0, 0], [1.5, 1, 1])
    both = merge(one, two)
    inner = np.flatnonzero((np.abs(both.rest[:, 1:] - 0.5) < 0.3).all(axis=1) & (both.rest[:, 0] > 0.1))
    inner = inner[both.rest[inner, 0] < 1.4]
    moves = {int(i): random.normal(size=3) * 0.03 for i in random.choice(inner, 12, replace=False)}
    smooth = both.moved_smoothly(moves)
    rough = both.moved(both.rest + sum(np.eye(len(both.rest))[i][:, None] * step for i, step in moves.items()))
    for x in (0.5, 1.0):
        joint = np.column_stack([np.full(200, x), random.uniform(0.05, 0.95, (200, 2))])
        assert jumps(smooth, joint, [1e-8, 0, 0]) < 1e-5 < 1e-2 < jumps(rough, joint, [1e-8, 0, 0])


def test_smooth_moves_go_where_they_were_asked_and_wrap_around():
    prism = ExtendedFFD.prism(cloud())
    block = prism.blocks[0]
    index = int(block.index[1, 2, 2])
    moved = prism.moved_smoothly({index: [0, 0, 1.0]})
    assert np.array_equal((moved.controls - prism.rest)[index], [0, 0, 1])
    tube = ExtendedFFD.cylinder(cloud(), shape=(8, 4, 7))
    joint = int(tube.blocks[0].index[0, 2, 3])
    changed = np.flatnonzero((tube.moved_smoothly({joint: [0, 0, 1.0]}).controls - tube.rest).any(axis=1))
    assert sorted(changed) == sorted(tube.blocks[0].index[0, 2, [2, 3, 4]])


def test_merged_lattices_share_what_they_have_in_common(random):
    points = random.uniform(-1, 1, (500, 3)) * [0.6, 0.6, 1]
    lower = ExtendedFFD.cylinder(points, margin=0.0)
    upper = lower.with_rest(lower.rest + [0, 0, np.ptp(lower.rest[:, 2])])
    column = merge(lower, upper)
    assert len(column.rest) == 2 * len(lower.rest) - (1 + 8 * 3)  # one disc is welded
    above = points + [0, 0, np.ptp(points[:, 2])]
    stacked = np.concatenate([points, above])
    assert len(column.bind(stacked).outside) == 0
    moved = displaced(column)
    check_deformer(moved, stacked[::10], smooth=lambda x: np.abs(x[:, 2] - upper.rest[:, 2].min()) > 0.02)
    seam = points.copy()
    seam[:, 2] = lower.rest[:, 2].max()
    assert np.abs(moved(seam + [0, 0, 1e-9]) - moved(seam - [0, 0, 1e-9])).max() < 1e-8  # C0
    mixed = merge(lower, box([-0.2, -0.2, 5], [0.2, 0.2, 6]))
    assert len(mixed.rest) == len(lower.rest) + 64
    with pytest.raises(InvalidDeformer, match=r"displaced differently .* merge lattices at rest"):
        merge(displaced(lower), upper)


def test_a_lattice_that_is_moved_rigidly_moves_its_points_rigidly(random):
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    for make in MAKERS.values():
        ffd = make(cloud())
        assert np.abs(ffd.moved(ffd.rest @ turn + 1)(cloud()) - cloud() @ turn - 1).max() < 1e-12


def test_errors_name_cause_and_cure():
    points = cloud()
    with pytest.raises(InvalidDeformer, match=r"\(8, 5, 4\); it must have .* 4, 7, 10"):
        ExtendedFFD.cylinder(points, shape=(8, 5, 4))
    with pytest.raises(InvalidDeformer, match="three sides or more"):
        ExtendedFFD.prism(points, sides=2)
    with pytest.raises(InvalidDeformer, match="'x', 'y' or 'z'"):
        ExtendedFFD.sphere(points, axis="w")
    with pytest.raises(InvalidDeformer, match="margin"):
        ExtendedFFD.sphere(points, margin=-0.5)
    with pytest.raises(InvalidTarget):
        ExtendedFFD.cylinder(np.empty((0, 3)))
    with pytest.raises(InvalidDeformer, match="block 0 uses control points that are not among the 3"):
        ExtendedFFD(points=np.zeros((3, 3)), blocks=box([0] * 3, [1] * 3).blocks)
    with pytest.raises(InvalidDeformer, match="control point 500 is not among"):
        ExtendedFFD.cylinder(points).moved_smoothly({500: [0, 0, 0]})


@pytest.mark.parametrize("points", [cloud() * [1, 1, 0], cloud() * [1, 0, 0], cloud(1), np.zeros((3, 3))])
def test_flat_and_thin_shapes_are_wrapped_too(points):
    for make in MAKERS.values():
        ffd = make(points, outside="error")
        assert np.abs(ffd.moved(ffd.rest + 1.0)(points) - points - 1).max() < 1e-12
