"""zxhproj ``.FFD``: a uniform cubic B-spline lattice of offsets along its own axes.

The map is x' = A(p + sum B B B offset) with p = A^-1 x and A = [axes | origin], the qform of NIfTI: RAS+,
millimetres. Its owner uses it to fetch each point of an image from where it came (pull-back).
"""

from __future__ import annotations

import re
import warnings
from collections import Counter
from collections.abc import Mapping
from math import prod
from operator import itemgetter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import PliantWarning
from pliant.io.map_formats.lattice_frame import LatticeFrame
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.zxhproj_ffd_write import write as write
from pliant.io.map_formats.zxhproj_header import FFDHeader
from pliant.io.map_formats.zxhproj_text import Block, read_blocks, required
from pliant.io.map_formats.zxhproj_variants import Layout, Shape, absolute, order_of, positions
from pliant.numerics.rigid.quaternions import axes_of
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD

Floats = NDArray[np.float64]
Blocks = Mapping[str, Block]

_SIX_DECIMALS = re.compile(rb"\.[0-9]{6}(?!\S)")
_LONGEST = 1.01  # the square of a quaternion's length, with room for rounding
_OFFSETS = "offsets of the control points"


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file; variant C gives a Bernstein lattice, the others a B-spline lattice."""
    blocks = read_blocks(path, data)
    dimension, shape, size_count = _size(path, blocks)
    block = required(path, blocks, _OFFSETS)
    values, row_lengths = _offsets(block, shape, dimension)
    per_point = values.size // prod(shape)
    spacing = np.ones(3)
    spacing[:size_count] = _spacing(path, blocks, size_count)
    layout = _layout(blocks, options, values, _points_a_line(row_lengths, per_point), shape, spacing)
    frame = _frame(blocks, spacing, options)
    offsets = np.zeros((*shape, 3))
    offsets[..., :per_point] = layout.arrange(values, shape)
    if layout.guessed:
        _warn(f"{path} is read as variant {layout.variant} ({layout.reason}); pass variant= to override")
    if "quaternion" not in blocks and options.origin is None and options.fit_to is None:
        _warn(
            f"{path} does not say where its lattice lies: control point (0, 0, 0) is put at (0, 0, 0); pass origin=, "
            "or placement='fit' with the mesh as target="
        )
    placed = frame if options.fit_to is None else frame.fitted(shape, options.fit_to, path)
    if layout.variant == "C":
        return _bernstein(offsets, placed)
    one_to_one = blocks["one to one"].text if "one to one" in blocks else "1"
    quaternion = blocks["quaternion"].text if "quaternion" in blocks else None
    header = FFDHeader(
        layout.variant, layout.reason, dimension, (size_count, per_point), one_to_one, quaternion, frame, offsets
    )
    return BSplineFFD(
        displacements=placed.world(offsets * (placed.spacing / frame.spacing)),
        origin=placed.origin,
        spacing=placed.spacing,
        axes=placed.axes,
        edge=options.edge,
        direction="pull-back",
        carrier=header,
    )


def _size(path: Path, blocks: Blocks) -> tuple[int, Shape, int]:
    """Dimension, (nx, ny, nz), and how many numbers the size has."""
    block = required(path, blocks, "dimension")
    found = block.integers()
    if found not in ([2], [3]):
        raise block.error(f"the dimension is {block.text[:40]!r}; 2 or 3 is expected")
    block = required(path, blocks, "control grid size")
    size = block.integers()
    if len(size) not in (found[0], 3):
        raise block.error(f"the size has {len(size)} numbers; a file of dimension {found[0]} has {found[0]}")
    if found[0] == 2 and len(size) == 3 and size[2] != 1:
        raise block.error(f"the lattice has {size[2]} layers; a file of dimension 2 has one")
    nx, ny, nz = [*size, 1][:3]
    return found[0], (nx, ny, nz), len(size)


def _spacing(path: Path, blocks: Blocks, count: int) -> Floats:
    block = required(path, blocks, "control grid spacing")
    spacing = block.numbers(count)
    if not (spacing > 0).all():
        raise block.error(f"the spacing is {spacing.tolist()}; it must be positive")
    return spacing


def _offsets(block: Block, shape: Shape, dimension: int) -> tuple[Floats, list[int]]:
    """The numbers in file order, and how many each line holds."""
    allowed = [prod(shape) * coordinates for coordinates in ((3,) if dimension == 3 else (2, 3))]
    expected = " or ".join(f"{count:,}" for count in allowed)
    lattice = f"{' x '.join(map(str, shape))} control points of {dimension} dimensions need {expected}"
    if len(block.body) < 2 * min(allowed) - 1:  # nothing is allocated for a lattice that cannot be there
        words = len(block.body.split())
        raise block.error(f"there are {words:,} offsets; {lattice}", "the file is truncated, or its size is wrong")
    rows = block.rows()
    lengths = [len(row) for row in rows]
    if sum(lengths) not in allowed:
        usual = max(Counter(filter(None, lengths)).items(), key=itemgetter(1), default=(0, 0))[0]
        odd = next((at for at, length in enumerate(lengths) if length not in (0, usual)), len(rows) - 1)
        raise block.error(f"there are {sum(lengths):,} offsets; {lattice}", "compare this line", line=block.line + odd)
    return block.floats(rows), lengths


def _points_a_line(row_lengths: list[int], per_point: int) -> list[int]:
    """-1 stands for a line that breaks a point in two."""
    return [-1 if length % per_point else length // per_point for length in row_lengths]


def _layout(
    blocks: Blocks, options: ReadOptions, values: Floats, row_lengths: list[int], shape: Shape, spacing: Floats
) -> Layout:
    if options.variant in ("A", "B", "D"):
        return Layout(options.variant, "as asked for", x_first=options.variant == "B")
    length = blocks["control grid spacing"].body
    is_genuine_format = (
        shape[0] == shape[2]
        and _all_six_decimals(length, len(length.split()))
        and _all_six_decimals(blocks[_OFFSETS].body, values.size)
    )
    layout = order_of(row_lengths, shape, is_genuine_format, "quaternion" in blocks)
    if options.variant == "C":
        return positions(layout, values, shape)
    return absolute(layout, values, shape, spacing)


def _frame(blocks: Blocks, spacing: Floats, options: ReadOptions) -> LatticeFrame:
    if "quaternion" in blocks:
        numbers = blocks["quaternion"].numbers(7)
        qfac, bcd, origin = float(numbers[0]), numbers[1:4], numbers[4:]
        if not bcd @ bcd < _LONGEST:
            raise blocks["quaternion"].error(f"qb, qc, qd = {bcd.tolist()} are no part of a unit quaternion")
        return LatticeFrame(origin, spacing, axes_of(qfac, bcd))
    origin = np.zeros(3) if options.origin is None else np.asarray(options.origin, np.float64)
    return LatticeFrame(origin, spacing, np.eye(3))


def _bernstein(controls: Floats, frame: LatticeFrame) -> BezierFFD:
    shape = controls.shape[:3]
    corners = frame.position(np.array([[0, 0, 0], np.array(shape) - 1], np.float64))
    return BezierFFD.around(corners, shape=shape, axes=frame.axes).moved(controls)


def _all_six_decimals(body: bytes, words: int) -> bool:
    return len(_SIX_DECIMALS.findall(body)) == words


def _warn(message: str) -> None:
    warnings.warn(message, PliantWarning, stacklevel=4)  # the caller of read_transform
