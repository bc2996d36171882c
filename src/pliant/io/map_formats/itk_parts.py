"""ITK's transforms between their numbers and pliant's deformers.

A transform is a kind, fixed parameters and parameters. ITK thinks in LPS, millimetres, and fetches each point of an
image from where it came (pull-back); a composite applies its last transform first. A B-spline moves nothing where its
support leaves the lattice, a displacement field nothing from half a voxel beyond its outermost voxels on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.image_formats.orientation import orthonormal
from pliant.io.map_formats.anatomy import half_turned
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.itk_matrices import RULES, affine_of
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import compose
from pliant.space.displacement_grid import DisplacementGrid

Floats = NDArray[np.float64]
Basic = Affine | BSplineFFD | DisplacementGrid

RIM = 0.5  # of a voxel: how far images reach beyond their voxels' centres
_LATTICES = ("BSplineTransform", "BSplineDeformableTransform")
FIELD = "DisplacementFieldTransform"
COMPOSITE = "CompositeTransform"
_GEOMETRY = 18  # size, origin, spacing and direction


@dataclass(frozen=True, eq=False)
class Part:
    """One transform of a file.

    Parameters
    ----------
    name
        Its class as the file says, as in ``BSplineTransform_double_3_3``.
    fixed, parameters
        (k,) numbers.
    place
        Where it stands in the file, for messages.
    line
        The same as a line of text, where there are lines.
    """

    name: str
    fixed: Floats
    parameters: Floats
    place: str
    line: int | None = None

    @property
    def kind(self) -> str:
        """The class without precision and dimensions."""
        return self.name.partition("_")[0]

    def error(self, path: Path, cause: str) -> UnreadableFile:
        """What is wrong with this transform."""
        return UnreadableFile(path, f"{self.place}, {self.name}: {cause}", "the file is damaged", line=self.line)


def deformer_of(path: Path, parts: Sequence[Part], form: str) -> SpaceDeformer:
    """The map that the transforms of a file describe, in RAS.

    Raises
    ------
    UnreadableFile
        Counts that contradict each other, or several transforms that nothing puts together.
    UnsupportedFormat
        A kind of transform that pliant does not have.
    """
    facts = FileFacts(form, {"transforms": ", ".join(part.name for part in parts)})
    components = [part for part in parts if part.kind != COMPOSITE]
    if not components:
        raise UnreadableFile(path, "the file holds no transform", "it may be cut off")
    if len(components) > 1 and parts[0].kind != COMPOSITE:
        raise UnreadableFile(
            path,
            f"the file holds {len(components)} transforms and does not say how they belong together",
            "put them into a CompositeTransform, or each into a file of its own",
        )
    maps = _joined([_basic(path, part) for part in reversed(components)])
    if len(maps) == 1:
        return replace(maps[0], carrier=facts)
    return compose(*maps)


def _basic(path: Path, part: Part) -> Basic:
    """The map of one transform, in RAS."""
    _require_solid(path, part)
    if part.kind in RULES:
        count = RULES[part.kind][0]
        if len(part.parameters) != count or len(part.fixed) not in (0, 3, 4):
            raise part.error(
                path,
                f"{len(part.parameters)} parameters and {len(part.fixed)} fixed parameters; "
                f"{count} and none, 3 or 4 are expected",
            )
        return half_turned(affine_of(part.kind, part.fixed, part.parameters))
    if part.kind not in (*_LATTICES, FIELD):
        raise UnsupportedFormat(
            f"{path}: {part.place} is a {part.kind}, which pliant does not read: there are {', '.join(RULES)}, "
            f"{', '.join(_LATTICES)}, {FIELD} and {COMPOSITE} (in ITK, convert it to a displacement field)"
        )
    if part.kind in _LATTICES:
        return half_turned(lattice_of(path, part))
    shape, origin, spacing, axes = _geometry(path, part)
    vectors = part.parameters.reshape(*reversed(shape), 3).transpose(2, 1, 0, 3)
    grid = DisplacementGrid(
        displacements=vectors, origin=origin, spacing=spacing, axes=axes, rim=RIM, direction="pull-back"
    )
    return half_turned(grid)


def lattice_of(path: Path, part: Part) -> BSplineFFD:
    """The cubic lattice of one transform, in LPS.

    Raises
    ------
    UnreadableFile
        Counts that contradict each other.
    """
    shape, origin, spacing, axes = _geometry(path, part)
    if min(shape) < 4:
        raise part.error(path, f"a cubic B-spline needs 4 control points an axis; there are {shape}")
    values = part.parameters.reshape(3, *reversed(shape)).transpose(3, 2, 1, 0)
    return BSplineFFD(
        displacements=values, origin=origin, spacing=spacing, axes=axes, edge="identity", direction="pull-back"
    )


def _require_solid(path: Path, part: Part) -> None:
    """Refuse what is not of space, or of another spline order."""
    words = part.name.split("_")[1:]
    numbers = [word for word in words if word.isdecimal()]
    if numbers and any(number != "3" for number in numbers):
        raise UnsupportedFormat(
            f"{path}: {part.place} is a {part.name}; pliant reads maps of space, and B-splines of order 3"
        )


def _geometry(path: Path, part: Part) -> tuple[tuple[int, int, int], Floats, Floats, Floats]:
    """Shape, origin, spacing and axes of a grid whose numbers are all there."""
    fixed = part.fixed
    if len(fixed) != _GEOMETRY:
        raise part.error(path, f"{len(fixed)} fixed parameters; a grid has {_GEOMETRY}")
    size, spacing = fixed[:3], fixed[6:9]
    if not ((size >= 1) & (size == np.round(size)) & (size < 1e6)).all():
        raise part.error(path, f"the size is {size.tolist()}; positive whole numbers are expected")
    if not (spacing > 0).all():
        raise part.error(path, f"the spacing is {spacing.tolist()}; it must be positive")
    nx, ny, nz = (int(n) for n in size)
    if len(part.parameters) != 3 * prod((nx, ny, nz)):
        raise part.error(path, f"{len(part.parameters):,} parameters; {nx} x {ny} x {nz} need {3 * nx * ny * nz:,}")
    return (nx, ny, nz), fixed[3:6], spacing, orthonormal(path, fixed[9:].reshape(3, 3))


def _joined(maps: list[Basic]) -> list[Basic]:
    """In the order of application, an affine map joined to the affine map or the lattice before it."""
    joined = maps[:1]
    for later in maps[1:]:
        earlier = joined[-1]
        if isinstance(later, Affine) and isinstance(earlier, Affine):
            joined[-1] = replace(later, matrix=later.matrix @ earlier.matrix)
        elif isinstance(later, Affine) and isinstance(earlier, BSplineFFD) and _is_regular(later.linear):
            joined[-1] = replace(
                earlier,
                affine=later.matrix @ earlier.affine,
                displacements=earlier.displacements @ later.linear.T,
            )
        else:
            joined.append(later)
    return joined


def _is_regular(linear: Floats) -> bool:
    return bool(np.linalg.cond(linear) < 1e12)
