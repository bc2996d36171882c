"""Displacement fields in MetaImage files: vectors and places in LPS, pull-back, as ITK writes them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pliant.deformer import Deformer, SpaceDeformer
from pliant.io.image_formats import metaimage
from pliant.io.map_formats.anatomy import SIGNS
from pliant.io.map_formats.displacement_images import grid_of, image_of_grid
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import require_usable
from pliant.io.report import LossReport, refuse_losses

NAME = "MetaImage displacement field"


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file."""
    image = metaimage.read(path, data)
    if image.values.ndim == 4 and image.values.shape[3] == 3:
        image = replace(image, values=require_usable(path, image.values, "displacements") * SIGNS)
    return grid_of(image, path, options, FileFacts(NAME))


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write a linear displacement grid.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    image, losses, notes = image_of_grid(deformer, path)
    refuse_losses(losses, path, strict=strict)
    metaimage.write(replace(image, values=image.values * SIGNS), path)
    return LossReport(path, NAME, losses, notes)
