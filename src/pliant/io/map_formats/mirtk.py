"""MIRTK's and IRTK's transformations, ``.dof`` and ``.dof.gz``: big-endian numbers, RAS, millimetres, pull-back.

A file is a magic number, a type and that type's numbers. Multi-level transformations (MFFD) hold an affine map and
lattices whose displacements are added to it; fluid ones apply their lattices one after another.
"""

from __future__ import annotations

import gzip
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.gzipped import inflated
from pliant.io.map_formats.displacement_images import NOTE
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.mirtk_lattice import LATTICES, Cursor, lattice_bytes, read_lattice
from pliant.io.map_formats.mirtk_matrices import COUNTS, matrix_of, parameters_of
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.report import LossReport, refuse_losses
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import Composition, compose
from pliant.space.summed import Summed

Floats = NDArray[np.float64]

NAME = "MIRTK dof"
_MAGIC = 815007
_LINEAR = {2: "rigid", 22: "similarity", 3: "affine"}
_AFFINE, _MFFD, _FLUID_OLD, _FLUID = 3, 7, 8, 81
_BSPLINE = 76
_MOST_LEVELS = 100
_BELIEVED = 64 << 20  # bytes that any compressed file may hold; larger ones in proportion
_PER_BYTE = 100


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file.

    Raises
    ------
    UnreadableFile
        Truncated, or numbers that contradict each other.
    UnsupportedFormat
        Velocities, time, or a type of other programs.
    """
    options.require_physical(path)
    cursor = Cursor(path, inflated(path, data, _BELIEVED + _PER_BYTE * len(data)))
    kind = _kind(cursor)
    facts = FileFacts(NAME, {"type": str(kind)})
    if kind in _LINEAR:
        return Affine(_matrix(cursor, kind), "pull-back", facts)
    if kind in LATTICES:
        return replace(read_lattice(cursor, kind, options.edge), carrier=facts)
    if kind not in (_MFFD, _FLUID_OLD, _FLUID):
        raise UnsupportedFormat(f"{path}: a transformation of type {kind}; {_known()} are read")
    count = int(cursor.take("i4", 1)[0])
    if not 0 <= count <= _MOST_LEVELS:
        raise cursor.error(f"{count} levels; 0 to {_MOST_LEVELS} are expected")
    first = _expect_linear(cursor)
    levels = [_level(cursor, options) for _ in range(count)]
    if kind == _MFFD:
        return _added(first, levels, facts)
    last = _expect_linear(cursor) if kind == _FLUID else np.eye(4)
    maps: list[SpaceDeformer] = [Affine(first, "pull-back"), *levels, Affine(last, "pull-back")]
    used = [each for each in maps if not (isinstance(each, Affine) and np.array_equal(each.matrix, np.eye(4)))]
    return compose(*used) if len(used) > 1 else next(iter(used), Affine(first, "pull-back", facts))


def _added(first: Floats, levels: Sequence[BSplineFFD], facts: FileFacts) -> SpaceDeformer:
    """x' = A x + the sum of the levels' displacements."""
    if not levels:
        return Affine(first, "pull-back", facts)
    joined = [replace(levels[0], affine=first, carrier=facts), *levels[1:]]
    return joined[0] if len(joined) == 1 else Summed(tuple(joined))


def _kind(cursor: Cursor) -> int:
    magic, kind = (int(number) for number in cursor.take("u4", 2))
    if magic != _MAGIC:
        raise cursor.error(f"the number {magic} stands where a transformation begins with {_MAGIC}")
    return kind


def _matrix(cursor: Cursor, kind: int) -> Floats:
    count = int(cursor.take("i4", 1)[0])
    if count not in COUNTS[_LINEAR[kind]]:
        raise cursor.error(f"{count} parameters; a {_LINEAR[kind]} map has {COUNTS[_LINEAR[kind]]}")
    matrix = matrix_of(cursor.numbers(count, "parameters"))
    if not np.isfinite(matrix).all() or np.linalg.matrix_rank(matrix[:3, :3]) < 3:
        raise cursor.error("the affine map flattens space: a scale is zero")
    return matrix


def _expect_linear(cursor: Cursor) -> Floats:
    kind = _kind(cursor)
    if kind not in _LINEAR:
        raise cursor.error(f"type {kind} stands where an affine map should")
    return _matrix(cursor, kind)


def _level(cursor: Cursor, options: ReadOptions) -> BSplineFFD:
    kind = _kind(cursor)
    if kind not in LATTICES:
        raise UnsupportedFormat(f"{cursor.path}: a level of type {kind}; {_known()} are read")
    return read_lattice(cursor, kind, options.edge)


def _known() -> str:
    return f"{', '.join(map(str, [*_LINEAR, *LATTICES, _MFFD, _FLUID_OLD, _FLUID]))} (affine maps and cubic B-splines)"


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write affine maps, lattices, sums of lattices (MFFD), and lattices one after another (fluid).

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    losses: list[str] = []
    data = _bytes(deformer, path, losses)
    refuse_losses(tuple(losses), path, strict=strict)
    packed = gzip.compress(data, 6, mtime=0) if path.name.lower().endswith(".gz") else data
    write_bytes(path, packed)
    pushed = getattr(deformer, "direction", "pull-back") != "pull-back"
    return LossReport(path, NAME, tuple(losses), (NOTE,) if pushed else ())


def _bytes(deformer: Deformer, path: Path, losses: list[str]) -> bytes:
    if isinstance(deformer, Affine):
        return _affine_bytes(deformer.matrix, path)
    if isinstance(deformer, BSplineFFD) and np.array_equal(deformer.affine, np.eye(4)):
        return _lattice(deformer, losses)
    maps: list[Deformer] = [deformer]
    if isinstance(deformer, Summed | Composition):
        maps = list(deformer.deformers)
    first, last = np.eye(4), np.eye(4)
    start, end = maps[0], maps[-1]
    if isinstance(deformer, Composition):
        if isinstance(start, Affine):
            first, maps = start.matrix, maps[1:]
        if maps and isinstance(end, Affine):
            last, maps = end.matrix, maps[:-1]
    elif isinstance(start, BSplineFFD):
        first, maps[0] = start.affine, replace(start, affine=np.eye(4))
    levels = [each for each in maps if isinstance(each, BSplineFFD) and np.array_equal(each.affine, np.eye(4))]
    if len(levels) < len(maps):
        kind = type(deformer).__name__
        raise UnsupportedFormat(
            f"{path}: MIRTK holds affine maps and B-spline lattices, added up or one after another, with an affine map "
            f"before (and after) them; this {kind} is no such map: sample or refit it"
        )
    fluid = isinstance(deformer, Composition)
    head = _head(_FLUID if fluid else _MFFD) + np.array(len(levels), ">i4").tobytes()
    body = head + _affine_bytes(first, path) + b"".join(_lattice(level, losses) for level in levels)
    return body + _affine_bytes(last, path) if fluid else body


def _head(kind: int) -> bytes:
    return np.array([_MAGIC, kind], ">u4").tobytes()


def _affine_bytes(matrix: Floats, path: Path) -> bytes:
    if np.linalg.cond(matrix[:3, :3]) > 1e12:
        raise UnsupportedFormat(f"{path}: the affine map flattens space; MIRTK's parameters cannot say that")
    numbers = parameters_of(matrix).astype(">f8")
    return _head(_AFFINE) + np.array(len(numbers), ">i4").tobytes() + numbers.tobytes()


def _lattice(ffd: BSplineFFD, losses: list[str]) -> bytes:
    if ffd.edge == "identity":
        losses.append("that nothing moves near the lattice's edge and beyond: readers let the displacement fade there")
    return _head(_BSPLINE) + lattice_bytes(ffd)
