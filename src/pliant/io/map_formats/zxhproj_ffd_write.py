"""Writes zxhproj ``.FFD``: always the genuine layout, with the number formats that its own programs use."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.map_formats import zxhproj_aff
from pliant.io.map_formats.lattice_frame import LatticeFrame
from pliant.io.map_formats.zxhproj_header import FFDHeader
from pliant.io.report import LossReport, refuse_losses
from pliant.numerics.rigid.quaternions import axes_of, rounded_quaternion
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD

Floats = NDArray[np.float64]

_DECIMALS = 6
_SAME = 1e-8  # displacements nearer to each other than this are the same in six decimals
_COARSE = 1e-4  # rounding above this part of the spacing is a loss, not a remark


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write a B-spline lattice; an affine part goes to an ``.AFF`` of the same name.

    Raises
    ------
    UnsupportedFormat
        Another deformer, or a lattice so fine that six decimals hold no spacing.
    """
    if not isinstance(deformer, BSplineFFD):
        raise UnsupportedFormat(_explain(deformer, path))
    header = deformer.carrier if isinstance(deformer.carrier, FFDHeader) else None
    frame, quaternion = _frame(deformer, header, path)
    offsets = _offsets(deformer, header, frame)
    error = _rounding(deformer, frame, offsets)
    losses, notes = _remarks(deformer, error)
    refuse_losses(losses, path, strict=strict)
    global_part = Affine(deformer.affine, deformer.direction)
    if not (deformer.affine == np.eye(4)).all():
        sibling = path.with_suffix(".aff" if path.suffix.islower() else ".AFF")
        losses += zxhproj_aff.write(global_part, sibling, strict=strict).losses
        notes += (f"the affine part is in {sibling.name}: the map is its matrix plus the offsets of this file",)
    one_to_one = header.one_to_one if header else "1"
    write_bytes(path, _text(offsets, frame, quaternion, one_to_one, header))
    return LossReport(path, "zxhproj FFD", losses, notes)


def _frame(deformer: BSplineFFD, header: FFDHeader | None, path: Path) -> tuple[LatticeFrame, str]:
    """The frame as a reader of the file will see it, and the text of the quaternion block."""
    same_axes = header is not None and bool((header.frame.axes == deformer.axes).all())
    same = header is not None and same_axes and bool((header.frame.origin == deformer.origin).all())
    spacing = np.round(deformer.spacing, _DECIMALS)
    if not (spacing > 0).all():
        raise UnsupportedFormat(
            f"{path}: the spacing {np.asarray(deformer.spacing).tolist()} is nothing in six decimals "
            "(scale the mesh up before, or choose another format)"
        )
    if header is not None and same and header.quaternion is not None:
        return LatticeFrame(header.frame.origin, spacing, header.frame.axes), header.quaternion
    qfac, bcd = rounded_quaternion(deformer.axes, _DECIMALS)
    axes = axes_of(qfac, bcd)
    origin = np.round(deformer.origin, _DECIMALS) + 0.0
    text = "{:f}\t {:f}\t{:f}\t{:f}\t {:f}\t{:f}\t{:f}".format(qfac, *bcd, *origin)
    return LatticeFrame(origin, spacing, axes), text


def _offsets(deformer: BSplineFFD, header: FFDHeader | None, frame: LatticeFrame) -> Floats:
    """(nx, ny, nz, 3) offsets along the file's axes: those that were read, wherever they still say the same."""
    offsets = frame.local(deformer.displacements)
    if header is None or header.offsets.shape != offsets.shape:
        return offsets
    difference = np.abs(frame.world(header.offsets) - deformer.displacements)
    unchanged = (difference < _SAME).all(axis=-1, keepdims=True)
    return np.where(unchanged, header.offsets, offsets)


def _rounding(deformer: BSplineFFD, frame: LatticeFrame, offsets: Floats) -> float:
    """The largest error of a control point's place at rest, or of its displacement, in the file."""
    corners = np.array(list(product(*((0, n - 1) for n in deformer.shape))), np.float64)
    exact = LatticeFrame(deformer.origin, deformer.spacing, deformer.axes)
    at_rest = np.linalg.norm(frame.position(corners) - exact.position(corners), axis=1).max()
    moved = np.linalg.norm(frame.world(np.round(offsets, _DECIMALS)) - deformer.displacements, axis=-1).max()
    return float(max(at_rest, moved))


def _remarks(deformer: BSplineFFD, error: float) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Losses and notes."""
    rounding = f"numbers are rounded to six decimals: control points are off by {error:.2g} at most"
    is_coarse = error > _COARSE * float(np.min(deformer.spacing))
    notes = [] if is_coarse or error == 0 else [rounding]
    notes.append(f"the edge policy, {deformer.edge!r}, is not stored: pass edge={deformer.edge!r} when reading")
    if deformer.direction != "pull-back":
        notes.append(f"the direction, {deformer.direction!r}, is not stored: readers take the map as 'pull-back'")
    return (rounding,) if is_coarse else (), tuple(notes)


def _text(
    offsets: Floats, frame: LatticeFrame, quaternion: str, one_to_one: str, header: FFDHeader | None
) -> Iterator[bytes]:
    nx, ny, nz = offsets.shape[:3]
    dimension, (size_count, per_point) = (header.dimension, header.coordinates) if header else (3, (3, 3))
    if nz > 1 or (per_point == 2 and offsets[..., 2].any()):
        dimension, size_count, per_point = 3, 3, 3
    size = "".join(f"{count}\n" for count in (nx, ny, nz)[:size_count])
    spacing = "".join(f"{length:15.6f}\n" for length in frame.spacing[:size_count])
    yield (
        f"#dimension#\n{dimension}\n#one to one#\n{one_to_one}\n#control grid size#\n{size}"
        f"#control grid spacing#\n{spacing}#offsets of the control points#\n"
    ).encode("latin-1")
    row = (" ".join(["%f"] * per_point) + "\t") * nx + "\n"
    slab = row * ny + "\n"  # the blank line after every slab, the last included, is what old readers stop at
    for z in range(nz):
        values = offsets[:, :, z, :per_point].transpose(1, 0, 2).reshape(-1)
        yield (slab % tuple(values.tolist())).encode("ascii")
    yield f"#quaternion qf,qb,qc,qd,qx,qy,qz#\n{quaternion}\n".encode("latin-1")


def _explain(deformer: Deformer, path: Path) -> str:
    kind = type(deformer).__name__
    if isinstance(deformer, Affine):
        return f"{path}: an .FFD file holds a B-spline lattice, not an affine map: write it to {path.stem}.AFF"
    return (
        f"{path}: an .FFD file holds one uniform B-spline lattice (BSplineFFD); {kind} is another map, which it holds "
        "only approximately: deform the mesh and write that"
    )
