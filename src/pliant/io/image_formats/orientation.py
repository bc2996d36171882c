"""Axes as image files give them: nearly orthonormal, and sometimes not at all."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantWarning, UnreadableFile

Floats = NDArray[np.float64]

_EXACT = 1e-14
_ROUNDING = 1e-6
_NEAR = 1e-3


def orthonormal(path: Path, axes: Floats) -> Floats:
    """Axes as orthonormal columns; those that are nearly so become the nearest that are.

    Rounding, as of axes in single precision, is mended in silence, more with a warning.

    Raises
    ------
    UnreadableFile
        Axes that are sheared or vanish.
    """
    off = float(np.abs(axes.T @ axes - np.eye(3)).max()) if np.isfinite(axes).all() else np.inf
    if off <= _EXACT:
        return axes
    if off > _NEAR:
        raise UnreadableFile(
            path,
            f"the axes {np.round(axes, 6).tolist()} are not orthonormal (off by {off:.2g})",
            "pliant's lattices are not sheared: resample the file to orthogonal axes",
        )
    u, _, v = np.linalg.svd(axes)
    if off > _ROUNDING:
        message = f"{path}: the axes are orthonormal to {off:.2g} only; the nearest orthonormal ones are taken"
        warnings.warn(message, PliantWarning, stacklevel=2)
    return np.asarray(u @ v, np.float64)


def split_matrix(path: Path, matrix: Floats) -> tuple[Floats, Floats, Floats]:
    """Origin, spacing and axes of a (4, 4) matrix from indices to positions.

    Raises
    ------
    UnreadableFile
        A matrix that is no lattice's.
    """
    if not np.isfinite(matrix).all():
        raise UnreadableFile(path, "the matrix from indices to positions is not finite", "the file is damaged")
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    if not (spacing > 0).all() or not (spacing < 1e100).all():
        raise UnreadableFile(path, f"the spacing is {spacing.tolist()}; it must be positive", "the file is damaged")
    return matrix[:3, 3].copy(), spacing, orthonormal(path, matrix[:3, :3] / spacing)
