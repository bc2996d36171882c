"""The colour bar, written onto the finished picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.rendering.palette import Theme
from pliant.rendering.quantities import Quantity

WIDTH = 0.13  # of the picture, kept free for the bar
Image = NDArray[np.uint8]


def with_legend(image: Image, paint: Quantity, unit: str, theme: Theme) -> Image:
    """The picture with a colour bar at its right: title and unit above, round numbers beside."""
    from PIL import Image as Pictures
    from PIL import ImageDraw, ImageFont

    height, width = image.shape[:2]
    text = round(0.024 * height)
    font = ImageFont.load_default(size=text)
    left, bar = round((1 - WIDTH) * width), round(0.016 * width)
    top, bottom = round(0.24 * height), round(0.80 * height)
    ink = tuple(round(255 * channel) for channel in theme.ink)
    ramp = paint.table[np.rint(np.linspace(len(paint.table) - 1, 0, bottom - top)).astype(int)]
    picture = image.copy()
    picture[top:bottom, left : left + bar, :3] = np.rint(255 * ramp)[:, None]
    picture[top:bottom, left : left + bar, 3:] = 255
    canvas = Pictures.fromarray(picture)
    pen = ImageDraw.Draw(canvas)
    title = f"{paint.title} ({unit})" if unit and paint.title else paint.title or unit
    pen.text((min(left, width - pen.textlength(title, font) - text), top - 1.1 * text), title, ink, font, anchor="ls")
    for value in round_numbers(paint.low, paint.high):
        y = bottom - 1 - (value - paint.low) / (paint.high - paint.low) * (bottom - 1 - top)
        pen.line([(left + bar, y), (left + bar + 0.3 * text, y)], ink, max(1, round(0.0012 * height)))
        pen.text((left + bar + 0.6 * text, y), f"{value:.6g}", ink, font, anchor="lm")
    return np.asarray(canvas)


def round_numbers(low: float, high: float, most: int = 6) -> NDArray[np.float64]:
    """(k,) multiples of 1, 2 or 5 times a power of ten between two values, at most ``most`` + 1 of them."""
    power = 10.0 ** np.floor(np.log10((high - low) / most))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor * most >= (high - low) * (1 - 1e-9))
    first, last = np.ceil(low / step - 1e-6), np.floor(high / step + 1e-6)
    return np.asarray(np.arange(first, last + 1) * step + 0.0)  # no negative zero
