"""elastix's parameter files, ``TransformParameters.0.txt``: LPS, millimetres, from the fixed image to the moving one.

A file names the transform that comes before it; both are composed, or their displacements added. Lattices are ITK's:
nothing moves where their support ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path, PureWindowsPath

import numpy as np

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.map_formats.anatomy import half_turned
from pliant.io.map_formats.elastix_text import Parameters, Words, parse, shown
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.itk_matrices import affine_of
from pliant.io.map_formats.itk_parts import Part, lattice_of
from pliant.io.map_formats.lattice_padding import surrounded
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.report import LossReport, refuse_losses
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import Composition, compose
from pliant.space.summed import Summed

NAME = "elastix parameters"
_KINDS = {
    "EulerTransform": ("Euler3DTransform", 6),
    "AffineTransform": ("AffineTransform", 12),
    "SimilarityTransform": ("Similarity3DTransform", 7),
    "TranslationTransform": ("TranslationTransform", 3),
}
_LATTICES = ("BSplineTransform", "RecursiveBSplineTransform")
_NONE = "NoInitialTransform"
_LONGEST_CHAIN = 32


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file, and of those before it, which lie in the same folder.

    Raises
    ------
    UnreadableFile
        Numbers that contradict each other, or a chain of files that is broken or bites its own tail.
    UnsupportedFormat
        A transform that pliant does not have.
    """
    options.require_physical(path)
    return _chain(path, data, ())


def _chain(path: Path, data: bytes, later: tuple[str, ...]) -> SpaceDeformer:
    parameters = parse(path, data)
    own = _own(path, parameters)
    before = parameters.text("InitialTransformParametersFileName", "") or parameters.text(
        "InitialTransformParameterFileName", _NONE
    )
    if before == _NONE:
        return own
    name = PureWindowsPath(before).name
    if not name or name in (*later, path.name) or len(later) > _LONGEST_CHAIN:
        raise UnreadableFile(path, f"the transform before it is {before!r}, which is none", "break the circle")
    earlier = _chain(path.with_name(name), read_bytes(path.with_name(name)), (*later, path.name))
    how = parameters.text("HowToCombineTransforms", "Compose")
    if how not in ("Compose", "Add"):
        raise UnreadableFile(path, f"HowToCombineTransforms is {how!r}", "it must be Compose or Add")
    return _composed(earlier, own) if how == "Compose" else _added(earlier, own)


def _composed(earlier: SpaceDeformer, later: SpaceDeformer) -> SpaceDeformer:
    if isinstance(earlier, Affine) and isinstance(later, Affine):
        return replace(later, matrix=later.matrix @ earlier.matrix)
    return compose(earlier, later)


def _added(earlier: SpaceDeformer, later: SpaceDeformer) -> SpaceDeformer:
    """T0(x) + T1(x) - x; an affine map and a lattice become one lattice."""
    if isinstance(earlier, Affine) and isinstance(later, BSplineFFD) and np.linalg.cond(earlier.linear) < 1e12:
        return replace(later, affine=earlier.matrix)
    return Summed((earlier, later))


def _own(path: Path, parameters: Parameters) -> Affine | BSplineFFD:
    """The map of one file without those before it, in RAS."""
    kind = parameters.text("Transform", "")
    facts = FileFacts(NAME, {"transform": kind})
    values = parameters.numbers("TransformParameters")
    if kind in _KINDS:
        name, count = _KINDS[kind]
        if len(values) != count:
            raise parameters.error("TransformParameters", f"{len(values)} numbers; {kind} has {count}")
        center = parameters.numbers("CenterOfRotationPoint", 3, np.zeros(3))
        zyx = parameters.text("ComputeZYX", "false").lower() == "true"
        return replace(half_turned(affine_of(name, np.append(center, float(zyx)), values)), carrier=facts)
    if kind not in _LATTICES:
        raise UnsupportedFormat(f"{path}: elastix's {kind or 'nothing'}; {', '.join([*_KINDS, *_LATTICES])} are read")
    if parameters.numbers("BSplineTransformSplineOrder", 1, np.array([3.0]))[0] != 3:
        raise UnsupportedFormat(f"{path}: a B-spline of another order than 3")
    if parameters.text("UseCyclicTransform", "false").lower() == "true":
        raise UnsupportedFormat(f"{path}: the lattice repeats itself (UseCyclicTransform)")
    direction = parameters.numbers("GridDirection", 9, np.eye(3).reshape(-1)).reshape(3, 3).T
    spacing, index = parameters.numbers("GridSpacing", 3), parameters.numbers("GridIndex", 3, np.zeros(3))
    origin = parameters.numbers("GridOrigin", 3) + direction @ (spacing * index)
    fixed = np.concatenate([parameters.numbers("GridSize", 3), origin, spacing, direction.reshape(-1)])
    part = Part("BSplineTransform_double_3_3", fixed, values, kind, parameters.line("TransformParameters"))
    return replace(half_turned(lattice_of(path, part)), carrier=facts)


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write affine maps, lattices, and chains of them: those before go to files of their own beside it.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    losses: list[str] = []
    files = _files(deformer, path, losses)
    refuse_losses(tuple(losses), path, strict=strict)
    for name, words in files:
        write_bytes(path.with_name(name), shown(words))
    names = [name for name, _ in files[:-1]]
    notes = ["the file has no image geometry: transformix needs Size, Spacing and Origin to resample an image"]
    notes += [f"what comes before it is in {', '.join(names)}"] if names else []
    return LossReport(path, NAME, tuple(losses), tuple(notes))


def _files(deformer: Deformer, path: Path, losses: list[str]) -> list[tuple[str, Words]]:
    """Names and contents, in the order of application."""
    maps, how = _steps(deformer)
    files: list[tuple[str, Words]] = []
    for at, each in enumerate(maps):
        last = at == len(maps) - 1
        before = files[-1][0] if files else _NONE
        words: Words = {
            "InitialTransformParametersFileName": [before],
            "InitialTransformParameterFileName": [before],
            "HowToCombineTransforms": [how],
            **_described(each, path, losses),
        }
        files.append((path.name if last else f"{path.stem}.before{at}{path.suffix}", words))
    return files


def _steps(deformer: Deformer) -> tuple[Sequence[Deformer], str]:
    if isinstance(deformer, Composition):
        return deformer.deformers, "Compose"
    if isinstance(deformer, Summed):
        return deformer.deformers, "Add"
    if isinstance(deformer, BSplineFFD) and not np.array_equal(deformer.affine, np.eye(4)):
        return (Affine(deformer.affine), replace(deformer, affine=np.eye(4))), "Add"
    return (deformer,), "Compose"


def _described(deformer: Deformer, path: Path, losses: list[str]) -> Words:
    common: Words = {"FixedImageDimension": [3], "MovingImageDimension": [3]}
    if isinstance(deformer, Affine):
        turned = half_turned(deformer)
        numbers = [*turned.linear.reshape(-1), *turned.offset]
        center = {"CenterOfRotationPoint": [0.0, 0.0, 0.0]}
        return {"Transform": ["AffineTransform"], "NumberOfParameters": [12], "TransformParameters": numbers,
                **common, **center}  # fmt: skip
    if not isinstance(deformer, BSplineFFD) or not np.array_equal(deformer.affine, np.eye(4)):
        raise UnsupportedFormat(
            f"{path}: elastix's files hold affine maps and B-spline lattices, not a {type(deformer).__name__}: sample "
            "or refit it"
        )
    ffd = half_turned(deformer)
    values, origin, lost = surrounded(ffd)
    losses += [loss for loss in lost if loss not in losses]
    return {
        "Transform": ["BSplineTransform"],
        "NumberOfParameters": [values.size],
        "TransformParameters": values.transpose(3, 2, 1, 0).reshape(-1).tolist(),
        **common,
        "GridSize": list(values.shape[:3]),
        "GridIndex": [0, 0, 0],
        "GridSpacing": ffd.spacing.tolist(),
        "GridOrigin": origin.tolist(),
        "GridDirection": ffd.axes.T.reshape(-1).tolist(),
        "BSplineTransformSplineOrder": [3],
        "UseCyclicTransform": ["false"],
    }
