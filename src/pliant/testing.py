"""What every deformer must satisfy, as one call: :func:`check_deformer`."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Binding, Deformer, Drag, LinearBinding, MeshDeformer, SpaceDeformer, Target
from pliant.errors import InvalidTarget, NotDifferentiable
from pliant.iterative import IterativeBinding, IterativeDrag
from pliant.mesh import Points, PolygonMesh, as_points

Floats = NDArray[np.float64]
Smooth = Callable[[Points], NDArray[np.bool_]]


def check_deformer(
    deformer: Deformer,
    target: Target,
    *,
    seed: int = 0,
    rest_image: Points | None = None,
    smooth: Smooth | None = None,
) -> None:
    """Assert the laws that all deformers share.

    At rest a deformer is the identity, or the declared offset; meshes and points give the same; nothing is mutated
    and nothing aliased; ``jvp`` and ``vjp`` are each other's transposes (to 1e-10) and the derivative of ``deform``;
    a drag agrees with ``deform``; a Jacobian agrees with finite differences (to 1e-6) and an inverse undoes the map;
    bindings pickle and serve several threads; points may be none, one, strided or float32.

    Parameters
    ----------
    deformer
        With controls away from rest, so that there is something to see. One that lives on a mesh rests where its
        binding says; one that iterates may drag to another minimum, but not to a higher one.
    target
        A mesh, or (n, 3) points for a space deformer; a few hundred points are enough.
    seed
        Of the random directions.
    rest_image
        (n, 3) where the points are at rest; None = where they were.
    smooth
        Tells for (n, 3) points which lie where the map is differentiable; None = all.

    Raises
    ------
    AssertionError
        Naming the law that does not hold.
    """
    random = np.random.default_rng(seed)
    points = as_points(target)
    scale = _diagonal(points)
    binding = deformer.bind(target)
    _check_rest(deformer, binding, target, points if rest_image is None else rest_image, scale)
    _check_calls(deformer, binding, target, scale)
    _check_nothing_changes(deformer, binding, points)
    if isinstance(deformer, MeshDeformer):
        _check_needs_a_mesh(deformer, points)
    _check_derivatives(binding, random, scale)
    _check_drag(binding, random, scale)
    _check_pickling_and_threads(deformer, binding, target)
    if isinstance(deformer, SpaceDeformer):
        _check_unusual_points(deformer, points, scale)
        _check_jacobian(deformer, points, scale, smooth)
        _check_inverse(deformer, points, scale)
    if isinstance(binding, LinearBinding):
        _check_weights(binding, random, scale)


def _diagonal(points: Points) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 1.0


def _close(one: Floats, two: Floats, tolerance: float, law: str) -> None:
    error = float(np.abs(np.asarray(one) - two).max(initial=0.0))
    assert error <= tolerance, f"{law}: off by {error:.3g}, allowed {tolerance:.3g}"


def _check_rest(deformer: Deformer, binding: Binding, target: Target, image: Points, scale: float) -> None:
    rest = binding.rest
    if not isinstance(deformer, MeshDeformer):
        assert np.array_equal(rest, deformer.rest), "a binding rests where its deformer does"
    _close(binding.deform(rest), image, 1e-12 * scale, "at rest every point is where it should be")
    _close(deformer.moved(rest).bind(target).deform(), image, 1e-12 * scale, "moved to rest is at rest")


def _check_needs_a_mesh(deformer: MeshDeformer, points: Points) -> None:
    try:
        deformer.bind(points)
    except InvalidTarget:
        return
    raise AssertionError("bare points are refused")


def _check_calls(deformer: Deformer, binding: Binding, target: Target, scale: float) -> None:
    expected = binding.deform()
    assert expected.shape == binding.points.shape, "deform gives a position a point"
    assert np.isfinite(expected).all(), "deform gives finite positions"
    _close(binding.deform(deformer.controls), expected, 1e-12 * scale, "deform() uses the deformer's own controls")
    again = deformer.moved(deformer.controls)
    _close(again.controls, deformer.controls, 1e-12 * scale, "moved to its own controls a deformer stays")
    result = deformer(target)
    if isinstance(target, PolygonMesh):
        assert isinstance(result, PolygonMesh), "mesh in, mesh out"
        _close(result.points, expected, 1e-12 * scale, "calling a mesh deforms its points")
        assert result.faces is target.faces, "faces ride along untouched"
        if isinstance(deformer, SpaceDeformer):
            _close(deformer(target.points), expected, 1e-12 * scale, "a mesh moves as its points do")
    else:
        _close(np.asarray(result), expected, 1e-12 * scale, "calling points deforms them")


def _check_nothing_changes(deformer: Deformer, binding: Binding, points: Points) -> None:
    before, controls, image = points.copy(), deformer.controls.copy(), binding.deform()
    image[:] = np.nan  # the caller may do what they like with a result
    again = binding.deform()
    assert np.isfinite(again).all(), "a result is never an alias"
    out = np.empty_like(again)
    assert binding.deform(out=out) is out, "out is returned"
    assert np.array_equal(out, again), "out is filled"
    assert np.array_equal(points, before), "the target is not changed"
    assert np.array_equal(deformer.controls, controls), "the deformer is not changed"


def _check_derivatives(binding: Binding, random: np.random.Generator, scale: float) -> None:
    controls = binding.controls
    direction = random.normal(size=controls.shape)
    gradient = random.normal(size=binding.points.shape)
    try:
        pushed = binding.jvp(controls, direction)
        pulled = binding.vjp(controls, gradient)
    except NotDifferentiable:
        return
    assert pulled.shape == controls.shape, "vjp gives a gradient shaped as the controls"
    one, two = float((pushed * gradient).sum()), float((direction * pulled).sum())
    size = float(np.linalg.norm(pushed) * np.linalg.norm(gradient)) or 1.0
    assert abs(one - two) <= 1e-10 * size, f"jvp and vjp are transposes: {one} and {two}"
    step = 1e-6 * (float(np.abs(controls).max()) or 1.0)
    ahead, behind = binding.deform(controls + step * direction), binding.deform(controls - step * direction)
    size = max(float(np.abs(pushed).max(initial=0.0)), 1e-3 * scale)
    _close((ahead - behind) / (2 * step), pushed, 1e-5 * size, "jvp is the derivative of deform")


def _check_drag(binding: Binding, random: np.random.Generator, scale: float) -> None:
    drag, controls = binding.drag(binding.rest), binding.rest.copy()
    _close(drag.points, binding.deform(binding.rest), 0.0, "a drag begins where deform is")
    rows = controls.reshape(-1, controls.shape[-1]) if controls.ndim > 1 else controls
    lead = controls.shape[:-1] if controls.ndim > 1 else controls.shape
    step = 0.01 * scale if controls.ndim > 1 else 0.01 * (float(np.abs(binding.controls).max()) or 1.0)
    for count in (1, 1, 2):
        chosen = random.choice(len(rows), size=min(count, len(rows)), replace=False)
        rows[chosen] += random.normal(size=rows[chosen].shape) * step
        before = drag.points.copy()
        touched = drag.update(controls, changed=[np.unravel_index(i, lead) for i in chosen])
        _check_dragged(drag, binding, controls, scale)
        moved = np.flatnonzero((drag.points != before).any(axis=1))
        assert np.isin(moved, touched).all(), "a drag names every point that it moved"
    assert not len(drag.update(controls, changed=[])), "nothing changed, nothing touched"
    assert not drag.points.flags.writeable, "a drag's points are read-only"


def _check_dragged(drag: Drag, binding: Binding, controls: Floats, scale: float) -> None:
    if isinstance(drag, IterativeDrag) and isinstance(binding, IterativeBinding):
        assert drag.solution is not None, "a drag gives an account"
        anew = binding.solve(controls).energy
        assert drag.solution.energy <= 1.01 * anew, "a drag ends about as low as deform does"
    else:
        _close(drag.points, binding.deform(controls), 1e-10 * scale, "a drag agrees with deform")


def _check_pickling_and_threads(deformer: Deformer, binding: Binding, target: Target) -> None:
    expected = binding.deform()
    assert np.array_equal(pickle.loads(pickle.dumps(binding)).deform(), expected), "a binding pickles"  # noqa: S301
    copy = pickle.loads(pickle.dumps(deformer))  # noqa: S301
    assert np.array_equal(copy.bind(target).deform(), expected), "a deformer pickles"
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: binding.deform(), range(8)):
            assert np.array_equal(result, expected), "a binding serves several threads"


def _check_unusual_points(deformer: SpaceDeformer, points: Points, scale: float) -> None:
    expected = deformer(points)
    assert deformer(np.empty((0, 3))).shape == (0, 3), "no points give no points"
    assert deformer.jacobian(np.empty((0, 3))).shape == (0, 3, 3), "no points give no Jacobians"
    _close(deformer(points[:1]), expected[:1], 1e-12 * scale, "one point moves as among many")
    strided = np.repeat(points, 2, axis=1)[:, ::2]
    _close(deformer(strided), expected, 1e-12 * scale, "strided points move as contiguous ones")
    single = points.astype(np.float32)
    _close(deformer(single), deformer(single.astype(np.float64)), 1e-12 * scale, "float32 is taken as its values")


def _check_jacobian(deformer: SpaceDeformer, points: Points, scale: float, smooth: Smooth | None) -> None:
    inside = points if smooth is None else points[smooth(points)]
    jacobian, step = deformer.jacobian(inside), 1e-5 * scale
    assert jacobian.shape == (len(inside), 3, 3), "a Jacobian a point"
    size = max(float(np.abs(jacobian).max(initial=0.0)), 1.0)
    for axis in range(3):
        h = step * np.eye(3)[axis]
        slope = 8 * (deformer(inside + h) - deformer(inside - h)) - deformer(inside + 2 * h) + deformer(inside - 2 * h)
        _close(slope / (12 * step), jacobian[:, :, axis], 1e-6 * size, "the Jacobian agrees with finite differences")


def _check_inverse(deformer: SpaceDeformer, points: Points, scale: float) -> None:
    image = deformer(points)
    if (np.linalg.det(deformer.jacobian(points)) <= 0).any():
        return  # a folding map has no inverse
    _close(deformer(deformer.inverse(image)), image, 1e-8 * scale, "the inverse undoes the map")


def _check_weights(binding: LinearBinding, random: np.random.Generator, scale: float) -> None:
    weights, change = binding.weights, random.normal(size=binding.rest.shape)
    coefficients = change.reshape(-1) if change.ndim == 1 else change.reshape(-1, 3)
    product = (weights @ coefficients).reshape(-1, 3)
    expected = binding.deform(binding.rest + change) - binding.deform(binding.rest)
    _close(product, expected, 1e-10 * max(scale, float(np.abs(expected).max(initial=0.0))), "x' = b + W (c - c_rest)")
