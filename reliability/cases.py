"""Deformers of every kind with parameters, controls and targets drawn at random."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import pliant as pl
from pliant.deformer import Deformer
from pliant.scene.layer import Layer
from pliant.space.summed import Summed
from reliability.targets import Case, Floats, Random, Target, body, cloud, disturbed, face, size_of


def _axis(random: Random) -> str:
    return "xyz"[random.integers(3)]


def _laid(make: Callable[[Floats, Random], Deformer], amount: float | None = None) -> Callable[[Random], Case]:
    """A case of a map of space: on points."""

    def case(random: Random) -> Case:
        target = cloud(random)
        deformer = make(target, random)
        return (deformer if amount is None else disturbed(deformer, target, random, amount)), target

    return case


def _axial(kind: str, **ranges: tuple[float, float]) -> Callable[[Random], Case]:
    """A case of a classical deformation: laid around points, its numbers drawn from ranges; "size" is the target's."""

    def make(target: Floats, random: Random) -> Deformer:
        size = float(np.linalg.norm(np.ptp(target, axis=0)))
        values = {name: random.uniform(*span) for name, span in ranges.items()}
        if "amplitude" in values:
            values["amplitude"] *= size
        made: Deformer = getattr(pl, kind).around(target, axis=_axis(random), **values)
        return made

    return _laid(make)


def _shape(random: Random, low: int, high: int) -> tuple[int, int, int]:
    x, y, z = (int(n) for n in random.integers(low, high + 1, 3))
    return x, y, z


def _sites(target: Floats, random: Random) -> Floats:
    return target[random.choice(len(target), 12, replace=False)]


def _warped(target: Floats, random: Random) -> tuple[Floats, Floats]:
    """Landmarks and where they go."""
    sites = _sites(target, random)
    return sites, sites + 0.05 * size_of(target) * random.normal(size=sites.shape)


def _cage(coordinates: str) -> Callable[[Random], Case]:
    def make(target: Floats, _: Random) -> Deformer:
        low, high = target.min(axis=0), target.max(axis=0)
        room = 0.3 * (high - low)
        box = pl.PolygonMesh(target, np.empty((0, 3), int))
        cage = pl.cage_from_box(box.with_points(np.clip(target, low, high)), cells=(1, 1, 2))
        middle = cage.points.mean(axis=0)
        grown = cage.with_points(middle + (cage.points - middle) * (1 + 2 * room / (high - low + room)))
        return pl.Cage(grown, coordinates=coordinates)  # type: ignore[arg-type]

    return _laid(make, 0.04)


def _edit(kind: str, given: pl.PolygonMesh | None = None) -> Callable[[Random], Case]:
    """A case of an edit of a surface: a part of a mesh, of which a part is held."""

    def case(random: Random) -> Case:
        mesh = body(random) if given is None else given
        far = np.linalg.norm(mesh.points - mesh.points[random.integers(len(mesh.points))], axis=1)
        order = np.argsort(far)
        roi, handle = np.sort(order[:50]), np.sort(order[:5])
        goal = mesh.points[handle] + 0.05 * mesh.diagonal * random.normal(size=3)
        return getattr(pl, kind)(roi, handle, goal=goal), mesh

    return case


def _kernel(target: Target, random: Random) -> pl.GaussianKernel:
    points = target.points if isinstance(target, pl.PolygonMesh) else target
    return pl.GaussianKernel(sigma=random.uniform(0.3, 0.9) * size_of(points), scale=0.05 * size_of(points))


def _model(random: Random) -> Case:
    whole = body(random)
    mesh = pl.PolygonMesh(whole.points, whole.triangles)
    model = pl.ShapeModel.from_kernel(mesh, _kernel(mesh, random), rank=6)
    return model.deformer(random.normal(size=model.count)), mesh


def _conditioned(random: Random) -> Case:
    whole = body(random)
    mesh = pl.PolygonMesh(whole.points, whole.triangles)
    model = pl.ShapeModel.from_kernel(mesh, _kernel(mesh, random), rank=6)
    seen = random.choice(len(mesh.points), int(random.integers(0, 4)), replace=False)
    places = model.mean[seen] + 0.03 * mesh.diagonal * random.normal(size=(len(seen), 3))
    noise = 10.0 ** random.uniform(-4, -1) * mesh.diagonal
    return pl.ConditionedModel(model, random.normal(size=model.count), seen, places, noise), mesh


def _keys(random: Random) -> Case:
    mesh = body(random)
    keys = 0.1 * mesh.diagonal * random.normal(size=(3, *mesh.points.shape))
    return pl.ShapeKeys(keys, ("a", "b", "c"), random.normal(size=3)), mesh


def _field(target: Floats, random: Random) -> Deformer:
    sites = _sites(target, random)
    moved = sites + 0.05 * size_of(target) * random.normal(size=sites.shape)
    process = pl.GaussianProcess(_kernel(target, random))
    return process.posterior(sites, moved - sites, noise=0.01 * size_of(target)).deformer()


def _grid(target: Floats, random: Random) -> Deformer:
    low, high = target.min(axis=0), target.max(axis=0)
    shape = _shape(random, 3, 6)
    spacing = (high - low) / (np.array(shape) - 1)
    moves = 0.05 * size_of(target) * random.normal(size=(*shape, 3))
    return pl.DisplacementGrid(displacements=moves, origin=low, spacing=spacing)


def _chain(target: Floats, random: Random) -> Deformer:
    lattice = pl.BSplineFFD.around(target, shape=_shape(random, 2, 4))
    return pl.compose(disturbed(lattice, target, random), pl.Twist.around(target, angle=random.uniform(-1, 1)))  # type: ignore[arg-type]


def _sum(target: Floats, random: Random) -> Deformer:
    lattice = pl.BSplineFFD.around(target, shape=_shape(random, 2, 4))
    parts = (disturbed(lattice, target, random), pl.Taper.around(target, factor=random.uniform(0.4, 1.6)))
    return Summed(parts)  # type: ignore[arg-type]


def _placed(target: Floats, random: Random) -> Deformer:
    lattice = pl.BSplineFFD.around(target, shape=_shape(random, 2, 4))
    move = pl.Affine.translation(0.1 * size_of(target) * random.normal(size=3))
    return pl.place(disturbed(lattice, target, random), move)  # type: ignore[arg-type]


def _inverse(target: Floats, random: Random) -> Deformer:
    """Of a map that does not fold, a lattice's or one about an axis."""
    lattice = disturbed(pl.BSplineFFD.around(target, shape=_shape(random, 2, 5)), target, random, 0.01)
    axial = pl.Twist.around(target, axis=_axis(random), angle=random.uniform(-1, 1))
    return pl.Inverse((lattice, axial)[random.integers(2)])  # type: ignore[arg-type]


def _stack(mode: str) -> Callable[[Random], Case]:
    """Layers on a mesh: an edit of the surface, a lattice not at full strength, a map about an axis."""

    def case(random: Random) -> Case:
        mesh = body(random)
        edit = _edit("LaplacianEdit", mesh)(random)[0]
        lattice = disturbed(pl.BSplineFFD.around(mesh, shape=_shape(random, 2, 4)), mesh, random)
        twist = pl.Twist.around(mesh, axis=_axis(random), angle=random.uniform(-1, 1))
        share = random.uniform(0.2, 1.0, len(mesh.points))
        layers = (Layer("edit", edit), Layer("lattice", lattice, mask=share), Layer("twist", twist, envelope=0.7))
        return pl.Stack(layers, mode), mesh  # type: ignore[arg-type]

    return case


def _handles(random: Random) -> Case:
    landmarks, near = face(random)
    return disturbed(pl.FaceHandles(landmarks), near, random, 0.01), near


def _caricature(random: Random) -> Case:
    landmarks, near = face(random)
    rest = pl.FaceCaricature(landmarks, expression=random.uniform(0, 1))
    return rest.moved(rest.rest + random.uniform(-0.5, 0.5, rest.rest.shape)), near


CASES: dict[str, Callable[[Random], Case]] = {
    "affine": _laid(lambda _, random: pl.Affine(np.vstack([
        np.hstack([np.eye(3) + 0.3 * random.normal(size=(3, 3)), random.normal(size=(3, 1))]), [0, 0, 0, 1]]))),
    "arap": _edit("ARAP"),
    "bend": _axial("Bend", angle=(-1.2, 1.2)),
    "bezier-ffd": _laid(lambda t, r: pl.BezierFFD.around(t, shape=_shape(r, 2, 5)), 0.05),
    "bezier-ffd, patches": _laid(lambda t, r: pl.BezierFFD.around(t, patches=_shape(r, 1, 2)), 0.05),
    "bezier-patch-ffd": _laid(lambda t, r: pl.BezierPatchFFD.around(t, axis=_axis(r)), 0.02),
    "bspline-ffd": _laid(lambda t, r: pl.BSplineFFD.around(t, shape=_shape(r, 2, 7)), 0.05),
    "cage, green": _cage("green"),
    "cage, harmonic": _cage("harmonic"),
    "cage, maximum entropy": _cage("maximum_entropy"),
    "cage, mean value": _cage("mean_value"),
    "cage, quad green": _cage("quad_green"),
    "cage, quad mean value": _cage("quad_mean_value"),
    "clamped-ffd": _laid(lambda t, r: pl.ClampedFFD.around(t, shape=_shape(r, 2, 6)), 0.05),
    "composition": _laid(_chain),
    "conditioned-model": _conditioned,
    "dirichlet-ffd": _laid(lambda t, r: pl.DirichletFFD(_sites(t, r)), 0.02),
    "dirichlet-ffd, smooth": _laid(lambda t, r: pl.DirichletFFD(_sites(t, r), smooth=True), 0.02),
    "displacement-grid": _laid(_grid),
    "extended-ffd, cylinder": _laid(lambda t, r: pl.ExtendedFFD.cylinder(t, axis=_axis(r)), 0.01),
    "extended-ffd, prism": _laid(lambda t, r: pl.ExtendedFFD.prism(t, _axis(r), int(r.integers(3, 8))), 0.01),
    "extended-ffd, sphere": _laid(lambda t, r: pl.ExtendedFFD.sphere(t, axis=_axis(r)), 0.01),
    "face-caricature": _caricature,
    "face-handles": _handles,
    "flare": _axial("Flare", start=(0.5, 1.5), end=(0.5, 1.5), bulge=(-0.3, 0.3)),
    "inverse": _laid(_inverse),
    "laplacian-edit": _edit("LaplacianEdit"),
    "model-deformer": _model,
    "placed": _laid(_placed),
    "radial-basis-warp": _laid(
        lambda t, r: pl.RadialBasisWarp(*_warped(t, r), support=size_of(t) * r.uniform(0.3, 1.5))
    ),
    "random-field": _laid(_field),
    "scale": _laid(lambda t, r: pl.Scale(x=r.uniform(0.4, 1.6), y=r.uniform(0.4, 1.6), origin=t.mean(axis=0))),
    "shape-keys": _keys,
    "sine": _axial("Sine", amplitude=(-0.1, 0.1), waves=(0.5, 3)),
    "skeleton-edit": _edit("SkeletonEdit"),
    "squash": _axial("Squash", factor=(0.4, 1.6)),
    "stack, added": _stack("add"),
    "stack, composed": _stack("compose"),
    "summed": _laid(_sum),
    "tangent-frames": _laid(lambda t, r: pl.TangentFrames.around(t, rates=0.3 * r.normal(size=(3, 4)))),
    "taper": _axial("Taper", factor=(0.4, 1.6)),
    "thin-plate-spline": _laid(lambda t, r: pl.ThinPlateSpline(*_warped(t, r))),
    "twist": _axial("Twist", angle=(-2, 2)),
    "wave": _axial("Wave", amplitude=(-0.1, 0.1), phase=(-3, 3)),
}  # fmt: skip
