"""What point caches share: positions as float32, and what they do not hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pliant.errors import UnsupportedFormat
from pliant.io.report import LossReport
from pliant.mesh import Points


def frame_of_float32(points: Points, path: Path, kind: str) -> bytes:
    """The bytes of (n, 3) positions.

    Raises
    ------
    UnsupportedFormat
        Positions beyond what float32 can hold.
    """
    with np.errstate(over="ignore"):
        stored = points.astype(kind)
    if not np.isfinite(stored).all():
        raise UnsupportedFormat(f"{path}: positions beyond 3.4e38 do not fit into float32; scale the mesh down")
    return stored.tobytes()


def cache_report(path: Path, name: str, *notes: str) -> LossReport:
    """The report of a file that holds positions only."""
    return LossReport(
        path,
        name,
        ("everything but positions: a program needs the mesh too, with its vertices in the same order",),
        ("coordinates are rounded to float32", *notes),
    )
