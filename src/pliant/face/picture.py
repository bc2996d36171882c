"""The piece of a photograph that a face wears."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pliant.io.files import write_bytes
from pliant.mesh import Points

if TYPE_CHECKING:
    from PIL.Image import Image

Floats = NDArray[np.float64]

MARGIN = 0.08  # of the size of the face, on each side
LARGEST = 2048  # pixels of the longer side; larger pieces are averaged
SMALLEST = 768  # the same; smaller ones are enlarged smoothly, since not everything that draws does so


@dataclass(frozen=True, eq=False)
class Picture:
    """A rectangle of a photograph.

    Parameters
    ----------
    pixels
        (h, w, 3) colours, the first row at the top.
    low, high
        (2,) where it lies in the photograph, in pixels of that.
    """

    pixels: NDArray[np.uint8]
    low: Floats
    high: Floats

    @classmethod
    def around(cls, image: Image, landmarks: Points) -> Picture:
        """The piece around the landmarks of a face, in pixels."""
        from PIL import Image as Pictures

        places = landmarks[:, :2]
        margin = MARGIN * np.ptp(places, axis=0).max()
        low = np.clip(np.floor(places.min(axis=0) - margin), 0, np.array(image.size) - 1)
        high = np.clip(np.ceil(places.max(axis=0) + margin), low + 1, image.size)
        piece = image.crop((int(low[0]), int(low[1]), int(high[0]), int(high[1])))
        size = np.array(piece.size)
        wanted = np.maximum(np.rint(size * np.clip(size.max(), SMALLEST, LARGEST) / size.max()), 1).astype(int)
        if (wanted != size).any():
            piece = piece.resize(tuple(wanted.tolist()), Pictures.Resampling.LANCZOS)
        return cls(np.asarray(piece), low, high)

    def coordinates(self, places: Floats) -> Floats:
        """(n, 2) texture coordinates, from the lower left corner, of (n, 2) pixels of the photograph."""
        u, v = ((places - self.low) / (self.high - self.low)).T
        return np.asarray(np.clip(np.column_stack([u, 1 - v]), 0, 1))

    @cached_property
    def file(self) -> Path:
        """The picture as a file, for whatever draws a mesh that wears it; it is gone when the program ends."""
        path = Path(_folder().name) / f"{id(self):x}.png"
        write_bytes(path, self.png())
        return path

    def __reduce__(self) -> tuple[object, ...]:
        return Picture, (self.pixels, self.low, self.high)

    def png(self) -> bytes:
        """The picture as a PNG file."""
        from PIL import Image as Pictures

        stream = BytesIO()
        Pictures.fromarray(self.pixels).save(stream, "PNG", compress_level=4)
        return stream.getvalue()


@cache
def _folder() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="pliant-face-")
