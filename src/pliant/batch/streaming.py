"""Points that no memory holds, deformed piece by piece: maps of space through Dask's arrays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidTarget, MissingExtra, UnreadableFile
from pliant.io.files import replacing
from pliant.mesh import Points
from pliant.scene.stack import Stack

ROWS = 1_000_000  # points in memory at a time, a worker


def stream(deformer: SpaceDeformer | Stack, points: Any) -> Any:
    """The deformed points as a Dask array: nothing is computed before they are asked for.

    Parameters
    ----------
    deformer
        A map of space: closed forms, lattices, cages and whatever moves a point by where it is; or a stack of them.
    points
        (n, 3) a Dask array, of which each piece fits into memory.

    Returns
    -------
    dask.array.Array
        (n, 3) float64, in pieces of the same rows.

    Raises
    ------
    InvalidTarget
        The deformer needs the whole shape, or this is no (n, 3) Dask array.
    MissingExtra
        Dask is not installed.
    """
    array = _dask_array()
    refuse_surfaces(deformer)
    if not isinstance(points, array.Array) or points.ndim != 2 or points.shape[1] != 3:
        raise InvalidTarget(
            f"an (n, 3) Dask array is needed, not {getattr(points, 'shape', type(points).__name__)}: make one by "
            "dask.array.from_array(points, chunks=(1_000_000, 3))"
        )
    rows = points.rechunk({1: 3})
    return rows.map_blocks(_piece, deformer, dtype=np.float64, meta=np.empty((0, 3)))


def stream_file(deformer: SpaceDeformer | Stack, path: Path | str, output: Path | str, *, rows: int = ROWS) -> int:
    """Deform the points of a ``.npy`` file into another, of which neither need fit into memory.

    Parameters
    ----------
    deformer
        As for :func:`stream`.
    path
        (n, 3) numbers.
    output
        Where the (n, 3) float64 deformed points are written; replaced once they are complete.
    rows
        How many points are in memory at a time, for each of Dask's workers.

    Returns
    -------
    int
        How many points there are.

    Raises
    ------
    UnreadableFile
        The file is no ``.npy`` file of (n, 3) numbers.
    InvalidTarget, MissingExtra
        As for :func:`stream`.
    """
    array = _dask_array()
    try:
        points = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise UnreadableFile(path, f"it is no .npy file: {error}", "write it by numpy.save") from error
    if points.ndim != 2 or points.shape[1] != 3 or points.dtype.kind not in "fiu":
        raise UnreadableFile(path, f"it holds {points.dtype} of shape {points.shape}", "(n, 3) numbers are needed")
    moved = stream(deformer, array.from_array(points, chunks=(max(1, rows), 3)))
    with replacing(output) as temporary:
        target = np.lib.format.open_memmap(temporary, "w+", np.float64, points.shape)
        if len(points):
            array.store(moved, target, lock=False)
        target.flush()
    return len(points)


def _piece(points: Any, deformer: SpaceDeformer | Stack) -> Points:
    piece = np.ascontiguousarray(points, np.float64)
    return np.asarray(deformer(piece)) if len(piece) else piece


def refuse_surfaces(deformer: object) -> None:
    """Make sure that a deformer needs no more than a piece of a shape.

    Raises
    ------
    InvalidTarget
        It needs the whole shape.
    """
    whole = _needs_all(deformer)
    if whole:
        raise InvalidTarget(f"{whole}: it cannot be applied piece by piece (deform the mesh itself)")


def _needs_all(deformer: object) -> str:
    """Why a deformer needs the whole shape; empty where it does not."""
    if isinstance(deformer, Stack):
        for layer in deformer.active:
            if layer.mask is not None or not layer.in_space:
                return f"layer {layer.name!r} " + ("is masked by vertices" if layer.in_space else "edits a surface")
        return ""
    return "" if isinstance(deformer, SpaceDeformer) else f"a {type(deformer).__name__} needs the whole shape"


def _dask_array() -> Any:
    try:
        import dask.array
    except ImportError:
        raise MissingExtra("streaming points", "dask") from None
    return dask.array
