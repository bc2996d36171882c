"""Boxes of control points in Plot3D's text, ``.xyz`` and ``.fmt``: as pyGeo and MACH-Aero read them; push-forward.

One block, its size, then the positions of all control points: all x, all y, all z, the first index fastest. The
undeformed box is not in the file: it is taken to be the parallelepiped through four corners, its control points
evenly spaced.
"""

from __future__ import annotations

import warnings
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidDeformer, PliantWarning, UnreadableFile, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import numbers, spaced
from pliant.io.report import LossReport, refuse_losses
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.clamped_ffd import ClampedFFD

Floats = NDArray[np.float64]

NAME = "Plot3D FFD box"
_SMALL = 4  # control points an axis, up to which clamped B-splines are Bernstein polynomials
_REST = 1e-9  # of the box: displacements below this are rounding


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The box of a file: a Bernstein lattice with up to four control points an axis, else clamped B-splines.

    Raises
    ------
    UnreadableFile
        Another count of numbers than the size says, or a box without volume.
    UnsupportedFormat
        Several blocks, or a flat one.

    Warns
    -----
    PliantWarning
        Control points that are moved: the box at rest is a guess.
    """
    options.require_physical(path)
    words = data.split(None, 4)
    if len(words) < 5 or not all(word.isdigit() for word in words[:4]):
        raise UnreadableFile(path, "a count of blocks and three sizes are expected first", "is it text?", line=1)
    blocks, nx, ny, nz = (int(word[:9]) for word in words[:4])
    if blocks != 1:
        raise UnsupportedFormat(f"{path}: {blocks} blocks; a box of one block is read")
    if min(nx, ny, nz) < 2:
        raise UnsupportedFormat(f"{path}: {nx} x {ny} x {nz} control points; at least two an axis make a box")
    count = 3 * prod((nx, ny, nz))
    values = numbers(path, words[4], 3, what="control points", count=count)
    controls = values.reshape(3, nz, ny, nx).transpose(3, 2, 1, 0)
    origin = controls[0, 0, 0]
    edges = np.stack([controls[-1, 0, 0] - origin, controls[0, -1, 0] - origin, controls[0, 0, -1] - origin], axis=1)
    kind = ClampedFFD if max(nx, ny, nz) > _SMALL else BezierFFD
    try:
        at_rest = kind(displacements=np.zeros_like(controls), origin=origin, edges=edges)
    except InvalidDeformer as error:
        raise UnreadableFile(path, str(error), "four corners of the box must span space") from error
    if _are_moved(controls - at_rest.rest, edges):
        warnings.warn(
            f"{path} holds moved control points and not where they were: the box at rest is taken from its corners "
            "(0, 0, 0), (n, 0, 0), (0, n, 0) and (0, 0, n)",
            PliantWarning,
            stacklevel=3,
        )
        return at_rest.moved(controls)
    return at_rest


def _are_moved(displacements: Floats, edges: Floats) -> bool:
    return bool(np.abs(displacements).max() > _REST * np.abs(edges).max())


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write clamped B-splines, or a Bernstein lattice of up to four control points an axis.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    small = isinstance(deformer, BezierFFD) and max(deformer.shape) <= _SMALL
    if not isinstance(deformer, ClampedFFD | BezierFFD) or not (small or isinstance(deformer, ClampedFFD)):
        raise UnsupportedFormat(
            f"{path}: a Plot3D box holds clamped B-splines (ClampedFFD, or a BezierFFD of up to {_SMALL} control "
            f"points an axis), not this {type(deformer).__name__}: refit it (pliant convert)"
        )
    if min(deformer.shape) < 2:
        raise UnsupportedFormat(f"{path}: {deformer.shape} control points; at least two an axis make a box")
    moved = np.abs(deformer.displacements) > _REST * np.abs(deformer.edges).max()
    corners = [moved[0, 0, 0], moved[-1, 0, 0], moved[0, -1, 0], moved[0, 0, -1]]
    lost = ["the box at rest: readers take it from four corners, and these were moved"] if np.any(corners) else []
    if getattr(deformer, "outside", "identity") != "identity" and moved.any():
        lost.append("what happens outside the box: there, points stay")
    losses = tuple(lost)
    refuse_losses(losses, path, strict=strict)
    controls = deformer.controls.transpose(2, 1, 0, 3)
    rows = [spaced(plane.reshape(-1)) + b"\n" for axis in range(3) for plane in controls[..., axis]]
    write_bytes(path, [b"1\n%d %d %d\n" % deformer.shape, *rows])
    notes = ("the undeformed box is not in the file, only where its control points are now",) if moved.any() else ()
    return LossReport(path, NAME, losses, notes)
