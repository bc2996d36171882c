"""Deformers as ITK's transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer
from pliant.errors import UnsupportedFormat
from pliant.io.map_formats.anatomy import half_turned
from pliant.io.map_formats.itk_parts import COMPOSITE, FIELD, RIM, Part
from pliant.io.map_formats.lattice_padding import surrounded
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.compose import Composition
from pliant.space.displacement_grid import DisplacementGrid

Floats = NDArray[np.float64]


def parts_of(deformer: Deformer, path: Path) -> tuple[list[Part], tuple[str, ...]]:
    """The transforms that hold a deformer, a composite first where there are several; and what they lose.

    Raises
    ------
    UnsupportedFormat
        A deformer that ITK has no transform for.
    """
    parts: list[Part] = []
    losses: list[str] = []
    for component in reversed(_components(deformer)):
        found, lost = _written(component, path)
        parts += found
        losses += lost
    if len(parts) > 1:
        nothing = np.empty(0)
        parts.insert(0, Part(f"{COMPOSITE}_double_3_3", nothing, nothing, ""))
    return parts, tuple(dict.fromkeys(losses))


def _components(deformer: Deformer) -> list[Deformer]:
    """In the order of application."""
    if not isinstance(deformer, Composition):
        return [deformer]
    return [part for each in deformer.deformers for part in _components(each)]


def _written(deformer: Deformer, path: Path) -> tuple[list[Part], tuple[str, ...]]:
    """The transforms of one map, the last applied first."""
    if isinstance(deformer, Affine):
        return [_affine_part(half_turned(deformer))], ()
    if isinstance(deformer, BSplineFFD):
        turned = half_turned(deformer)
        linear = turned.affine[:3, :3]
        if np.array_equal(turned.affine, np.eye(4)):
            after = []
        else:
            turned = replace(turned, displacements=turned.displacements @ np.linalg.inv(linear).T)
            after = [_affine_part(Affine(turned.affine))]
        values, origin, losses = surrounded(turned)
        fixed = _fixed(values.shape[:3], origin, turned.spacing, turned.axes)
        flat = values.transpose(3, 2, 1, 0).reshape(-1)
        return [*after, Part("BSplineTransform_double_3_3", fixed, flat, "")], losses
    if isinstance(deformer, DisplacementGrid) and deformer.interpolation == "linear":
        grid = half_turned(deformer)
        fixed = _fixed(deformer.shape, grid.origin, grid.spacing, grid.axes)
        flat = grid.displacements.transpose(2, 1, 0, 3).reshape(-1)
        same = deformer.outside == "identity" and deformer.rim == RIM
        lost = () if same else ("the grid's border: half a spacing beyond its outermost nodes nothing moves any more",)
        return [Part(f"{FIELD}_double_3_3", fixed, flat, "")], lost
    raise UnsupportedFormat(
        f"{path}: ITK has no transform for a {type(deformer).__name__}: sample it with pliant.to_grid, or convert it "
        "with a refit, and write that"
    )


def _affine_part(affine: Affine) -> Part:
    numbers = np.concatenate([affine.linear.reshape(-1), affine.offset])
    return Part("AffineTransform_double_3_3", np.zeros(3), numbers, "")


def _fixed(shape: Sequence[int], origin: Floats, spacing: Floats, axes: Floats) -> Floats:
    return np.concatenate([np.array(shape, np.float64), origin, spacing, axes.reshape(-1)])
