"""Images whose voxels are displacements, and displacement grids as images."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from pliant.deformer import Deformer
from pliant.errors import UnsupportedFormat
from pliant.io.image_formats.image import Image
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import require_usable
from pliant.space.displacement_grid import DisplacementGrid

RIM = 0.5  # of a voxel: how far images reach beyond their voxels' centres
NOTE = "the direction is not stored: readers take the map as 'pull-back'"


def grid_of(image: Image, path: Path, options: ReadOptions, carrier: Any) -> DisplacementGrid:
    """An image of (nx, ny, nz, 3) displacements, all in RAS, as a deformer.

    Raises
    ------
    UnreadableFile
        Displacements that are not finite.
    UnsupportedFormat
        Another number of numbers a voxel.
    InvalidParameter
        ``placement="fit"``.
    """
    options.require_physical(path)
    if image.values.ndim != 4 or image.values.shape[3] != 3:
        raise UnsupportedFormat(
            f"{path}: an image of {image.values.shape} numbers is no displacement field (3 a voxel); "
            "'pliant warp' deforms images"
        )
    return DisplacementGrid(
        displacements=require_usable(path, image.values, "displacements"),
        origin=image.origin,
        spacing=image.spacing,
        axes=image.axes,
        rim=RIM,
        direction="pull-back",
        carrier=carrier,
    )


def image_of_grid(deformer: Deformer, path: Path) -> tuple[Image, tuple[str, ...], tuple[str, ...]]:
    """A linear displacement grid as an image in RAS, with losses and notes.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    grid = required_grid(deformer, path, "an image of displacements")
    image = Image(grid.displacements, grid.origin, grid.spacing, grid.axes)
    same = grid.outside == "identity" and grid.rim == RIM
    losses = () if same else ("the grid's border: readers let nothing move from half a voxel beyond it on",)
    notes = (NOTE,) if grid.direction != "pull-back" else ()
    return image, losses if np.any(grid.displacements) else (), notes


def required_grid(deformer: Deformer, path: Path, holder: str) -> DisplacementGrid:
    """The deformer, if it is what ``holder`` can hold: a linear displacement grid.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    if not isinstance(deformer, DisplacementGrid) or deformer.interpolation != "linear":
        raise UnsupportedFormat(
            f"{path}: {holder} holds a linear DisplacementGrid, not this {type(deformer).__name__}: sample it with "
            "pliant.to_grid, or convert it with a refit"
        )
    return deformer
