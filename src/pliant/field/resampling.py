"""Images through a map: each point of the new image fetches its value from where the map takes it (pull-back)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.io.images import Image

Floats = NDArray[np.float64]
Interpolation = Literal["linear", "cubic"]

_RIM = 0.5  # of a voxel: how far an image reaches beyond its voxels' centres
_SLAB = 1 << 20  # voxels fetched together


def warp_image(
    image: Image,
    deformer: SpaceDeformer,
    *,
    reference: Image | None = None,
    interpolation: Interpolation = "linear",
    fill: float = 0.0,
) -> Image:
    """An image deformed: its value at x is that of the given image at T(x).

    Registration files hold T as it is needed here (pull-back). To carry an image along a map that pushes forward, pass
    the map's inverse.

    Parameters
    ----------
    image
        The image, RAS.
    deformer
        The map T, RAS.
    reference
        The grid of the result; None = that of the image.
    interpolation
        ``"linear"``, or ``"cubic"``: the cubic B-spline through the voxels, mirrored at the outermost ones.
    fill
        The value of points that T takes out of the image, farther than half a voxel beyond the centres of its
        outermost voxels.

    Returns
    -------
    Image
        Of the image's own type; whole numbers are rounded (ITK cuts them off), and kept within their range.

    Raises
    ------
    InvalidParameter
        Another interpolation.
    """
    if interpolation not in ("linear", "cubic"):
        raise InvalidParameter(f"interpolation={interpolation!r} is no choice; there are: 'linear', 'cubic'")
    grid = image if reference is None else reference
    channels = image.values.shape[3:]
    sources = _prepared(image.values.reshape(*image.shape, -1), interpolation)
    flat = np.empty((int(np.prod(grid.shape)), len(sources)), image.values.dtype)
    for start in range(0, len(flat), _SLAB):
        index = np.arange(start, min(start + _SLAB, len(flat)))
        points = _positions(grid, np.stack(np.unravel_index(index, grid.shape), axis=1))
        places = (deformer(points) - image.origin) @ image.axes / image.spacing
        flat[index] = _typed(_fetched(sources, places, image.shape, interpolation, fill), image.values.dtype)
    return replace(grid, values=flat.reshape(*grid.shape, *channels), carrier=grid.carrier)


def _positions(grid: Image, index: NDArray[np.int64]) -> Floats:
    return np.asarray(grid.origin + (index * grid.spacing) @ grid.axes.T)


def _prepared(values: NDArray[Any], interpolation: Interpolation) -> list[Floats]:
    """Each channel as float64; for cubic interpolation, its B-spline coefficients."""
    from scipy.ndimage import spline_filter

    channels = [np.ascontiguousarray(values[..., c], np.float64) for c in range(values.shape[3])]
    return channels if interpolation == "linear" else [spline_filter(c, 3, mode="mirror") for c in channels]


def _fetched(
    sources: list[Floats], places: Floats, shape: tuple[int, int, int], interpolation: Interpolation, fill: float
) -> Floats:
    """(k, channels) values at (k, 3) places in voxels."""
    from scipy.ndimage import map_coordinates

    order, mode = (1, "nearest") if interpolation == "linear" else (3, "mirror")
    inside = ((places >= -_RIM) & (places < np.array(shape) - 1 + _RIM)).all(axis=1)
    result = np.full((len(places), len(sources)), fill)
    for c, source in enumerate(sources):
        result[inside, c] = map_coordinates(source, places[inside].T, order=order, mode=mode, prefilter=False)
    return result


def _typed(values: Floats, dtype: np.dtype[Any]) -> NDArray[Any]:
    if dtype.kind == "f":
        return values.astype(dtype)
    limits = np.iinfo(dtype)
    return np.clip(np.floor(values + 0.5), limits.min, limits.max).astype(dtype)
