"""Colours as files store them: bytes from 0 to 255, or fractions of one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def as_float(colors: NDArray[Any]) -> NDArray[np.float64]:
    """Colours as fractions; whole numbers are taken as parts of their type's largest."""
    if np.issubdtype(colors.dtype, np.integer):
        return colors / float(np.iinfo(colors.dtype).max)
    return np.asarray(colors, np.float64)


def as_bytes(colors: NDArray[Any]) -> NDArray[np.uint8]:
    """Colours as bytes, rounded and clipped."""
    if colors.dtype == np.uint8:
        return colors
    return np.clip(np.rint(as_float(colors) * 255), 0, 255).astype(np.uint8)


def is_color(values: NDArray[Any]) -> bool:
    """Whether an attribute has the shape of colours: three or four columns."""
    return values.ndim == 2 and values.shape[1] in (3, 4)
