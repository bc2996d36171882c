"""Colours: the ones that things have, and maps whose every step looks equally large.

The maps are straight lines in the OKLab space (Ottosson 2020), in which equal distances look equal, through a few
colours whose lightness changes evenly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Stops = tuple[tuple[float, float, float], ...]

CLAY = (0.80, 0.83, 0.87)
CONTROL = (0.93, 0.60, 0.12)
MOVED = (0.83, 0.15, 0.24)
CHECKER = ((0.93, 0.94, 0.96), (0.25, 0.47, 0.74))

# OKLab lightness, chroma, hue in degrees
SEQUENTIAL: Stops = (
    (0.93, 0.045, 95),
    (0.81, 0.125, 78),
    (0.69, 0.165, 45),
    (0.57, 0.185, 8),
    (0.45, 0.165, 325),
    (0.33, 0.13, 290),
)
DIVERGING: Stops = ((0.40, 0.12, 258), (0.64, 0.12, 250), (0.94, 0.01, 250), (0.64, 0.16, 35), (0.40, 0.14, 25))


@dataclass(frozen=True)
class Theme:
    """What a picture stands on, and what is written and drawn upon it."""

    background: tuple[float, float, float]
    ink: tuple[float, float, float]
    faint: tuple[float, float, float]
    grid: tuple[float, float, float]
    sequence: Stops  # from near the background to far from it: what is large stands out


LIGHT = Theme((0.985, 0.985, 0.99), (0.20, 0.22, 0.26), (0.72, 0.75, 0.79), (0.16, 0.53, 0.50), SEQUENTIAL)
DARK = Theme((0.085, 0.095, 0.115), (0.88, 0.89, 0.91), (0.34, 0.37, 0.42), (0.30, 0.72, 0.67), SEQUENTIAL[::-1])
THEMES = {"light": LIGHT, "dark": DARK, "transparent": LIGHT}


def color_table(stops: ArrayLike, count: int = 256) -> Floats:
    """(count, 3) sRGB colours in [0, 1] along a polyline of (lightness, chroma, hue in degrees) stops."""
    lightness, chroma, hue = np.asarray(stops, np.float64).T
    lab = np.stack([lightness, chroma * np.cos(np.radians(hue)), chroma * np.sin(np.radians(hue))], axis=1)
    at = np.linspace(0, len(lab) - 1, count)
    return oklab_to_srgb(np.stack([np.interp(at, np.arange(len(lab)), column) for column in lab.T], axis=1))


def oklab_to_srgb(lab: ArrayLike) -> Floats:
    """(n, 3) OKLab to sRGB in [0, 1]; what no screen shows is clipped."""
    to_roots = np.array(
        [[1, 0.3963377774, 0.2158037573], [1, -0.1055613458, -0.0638541728], [1, -0.0894841775, -1.2914855480]]
    )
    to_linear = np.array(
        [
            [4.0767416621, -3.3077115913, 0.2309699292],
            [-1.2684380046, 2.6097574011, -0.3413193965],
            [-0.0041960863, -0.7034186147, 1.7076147010],
        ]
    )
    linear = np.clip((np.asarray(lab) @ to_roots.T) ** 3 @ to_linear.T, 0, 1)
    return np.asarray(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))
