"""Photographs: read as they shall be seen, whatever they are stored as."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.face.networks import MissingNetworks

if TYPE_CHECKING:
    from PIL.Image import Image

MOST_PIXELS = 200_000_000
LEAST_SIDE = 32


def read_photograph(source: Path | str | ArrayLike) -> Image:
    """A photograph in RGB, the right way up.

    Parameters
    ----------
    source
        A PNG, JPEG, WebP or TIFF file, turned as its EXIF orientation says, grey, with a palette, in CMYK, or with
        transparency (which is put on white); or an array of pixels: (h, w), (h, w, 3) or (h, w, 4), uint8, or floats
        between 0 and 1.

    Raises
    ------
    UnreadableFile
        No picture, a truncated one, or one of more than 200 million pixels.
    InvalidParameter
        An array of another shape or type, or a side below 32 pixels.
    MissingExtra
        Pillow is not installed.
    """
    try:
        from PIL import Image as Pictures
    except ImportError as error:
        raise MissingNetworks("the package 'pillow'") from error
    if isinstance(source, str | Path):
        return _checked(_opened(Path(source)))
    return _checked(_in_rgb(Pictures.fromarray(_bytes(np.asarray(source)))))


def _opened(path: Path) -> Image:
    from PIL import Image as Pictures
    from PIL import ImageOps

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Pictures.DecompressionBombWarning)  # the limit is checked below
            with Pictures.open(path) as image:
                width, height = image.size
                if width * height > MOST_PIXELS:
                    cause = f"the picture has {width} × {height} pixels; at most {MOST_PIXELS:,} are looked at"
                    raise UnreadableFile(path, cause, "make it smaller")
                return _in_rgb(ImageOps.exif_transpose(image))
    except FileNotFoundError as error:
        raise UnreadableFile(path, "no such file", "check the path") from error
    except (OSError, ValueError, SyntaxError, Pictures.DecompressionBombError) as error:
        cause = " ".join(str(error).split()).replace(f" '{path}'", "")
        raise UnreadableFile(
            path, f"it cannot be read as a picture: {cause}", "give a whole PNG, JPEG or WebP file"
        ) from error


def _in_rgb(image: Image) -> Image:
    """Eight bits a colour; what is transparent is put on white."""
    from PIL import Image as Pictures

    if image.mode.startswith(("I", "F")):  # sixteen bits and more, without a colour
        values = np.asarray(image, np.float64)
        top = 255.0 if values.max(initial=0.0) <= 255 else 65535.0
        return Pictures.fromarray(np.uint8(np.clip(values / top, 0, 1) * 255)).convert("RGB")
    if image.mode in {"RGBA", "LA", "PA", "La", "RGBa"} or "transparency" in image.info:
        layer = image.convert("RGBA")
        white = Pictures.new("RGBA", image.size, "white")
        return Pictures.alpha_composite(white, layer).convert("RGB")
    return image.convert("RGB")


def _bytes(pixels: NDArray[np.generic]) -> NDArray[np.uint8]:
    known = pixels.ndim == 2 or (pixels.ndim == 3 and pixels.shape[2] in (3, 4))
    if not known or not pixels.size or (pixels.dtype != np.uint8 and pixels.dtype.kind != "f"):
        raise InvalidParameter(
            f"pixels are {pixels.dtype} of shape {pixels.shape}; (h, w), (h, w, 3) or (h, w, 4) is needed, uint8 or "
            "floats between 0 and 1"
        )
    if pixels.dtype == np.uint8:
        return np.asarray(pixels, np.uint8)
    values = np.asarray(pixels, np.float64)
    if not np.isfinite(values).all() or values.min() < 0 or values.max() > 1:
        raise InvalidParameter("pixels that are floats lie between 0 and 1")
    return np.asarray(np.rint(255 * values), np.uint8)


def _checked(image: Image) -> Image:
    if min(image.size) < LEAST_SIDE:
        raise InvalidParameter(
            f"the picture has {image.width} × {image.height} pixels: {LEAST_SIDE} a side are the least in which a face "
            "is looked for; give a larger one"
        )
    return image
