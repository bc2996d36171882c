"""Square windows into a photograph, turned and scaled: what a network is shown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from PIL.Image import Image

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Window:
    """A square in a photograph.

    Parameters
    ----------
    x, y
        Its middle, in pixels from the upper left corner.
    side
        Its side in pixels.
    angle
        How far it is turned, radians, from x to y: clockwise as one looks at it.
    """

    x: float
    y: float
    side: float
    angle: float = 0.0

    @classmethod
    def around(cls, image: Image, angle: float = 0.0) -> Window:
        """The least upright square that holds a whole photograph, then turned."""
        return cls(image.width / 2, image.height / 2, max(image.size), angle)

    def seen(self, image: Image, size: int) -> Floats:
        """(size, size, 3) colours between 0 and 1; black beyond the photograph."""
        from PIL import Image as Pictures

        corners = self.outside(np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]]))
        low = np.maximum(np.floor(corners.min(axis=0)) - 1, 0).astype(int)
        high = np.minimum(np.ceil(corners.max(axis=0)) + 1, image.size).astype(int)
        if (low >= high).any():
            return np.zeros((size, size, 3))
        shrink = max(1, int(self.side / (1.5 * size)))  # averaged first, so that fine detail does not alias
        piece = image.reduce(shrink, (*low, *high)) if shrink > 1 else image.crop((*low, *high))
        origin, right, down = self.outside(np.array([[0, 0], [1, 0], [0, 1.0]]))
        origin = (origin - low) / shrink
        right, down = (right - self._corner) / (shrink * size), (down - self._corner) / (shrink * size)
        data = (right[0], down[0], origin[0], right[1], down[1], origin[1])
        small = piece.transform((size, size), Pictures.Transform.AFFINE, data, Pictures.Resampling.BILINEAR)
        return np.asarray(small, np.float64) / 255

    def outside(self, places: Floats) -> Floats:
        """(n, 2) pixels in the photograph of (n, 2) places in the window, which goes from 0 to 1."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        turn = np.array([[cosine, sine], [-sine, cosine]])
        return np.asarray([self.x, self.y] + self.side * (places - 0.5) @ turn)

    @property
    def _corner(self) -> Floats:
        return np.asarray(self.outside(np.zeros((1, 2)))[0])
