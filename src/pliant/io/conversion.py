"""Transforms into formats that may not hold them: exactly where the bases agree, by a reported refit where not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter, UnsupportedFormat
from pliant.io.map_formats.transform_format import TransformFormat
from pliant.io.map_formats.transform_formats import known_endings, transform_format
from pliant.io.report import LossReport, refuse_losses
from pliant.mesh import PolygonMesh
from pliant.space.affine import Affine
from pliant.space.compose import Composition, compose
from pliant.space.inverse import Inverse
from pliant.space.refit import Kind, Refit, Shape, refit
from pliant.space.region import Region, continued, region_of

_COUNTS: dict[Kind, tuple[int, int, int]] = {  # the fewest and the most that are chosen, and where nothing is known
    "bspline": (4, 40, 16),
    "bernstein": (4, 10, 8),
    "clamped": (4, 24, 10),
    "grid": (64, 256, 64),
    "affine": (2, 2, 2),
}
_EXACT = 1e-9  # of the box: a residual below this is rounding


def convert_transform(
    deformer: SpaceDeformer,
    path: Path | str,
    *,
    around: PolygonMesh | ArrayLike | None = None,
    shape: Shape | None = None,
    strict: bool = False,
) -> LossReport:
    """Write a deformer to a transform file, refitted where the format does not hold its kind.

    Parameters
    ----------
    deformer
        Any map of space.
    path
        Where to; its ending names the format.
    around
        A mesh or (n, 3) points, whose box a refit covers; None = the box of the deformer's own lattice.
    shape
        Numbers of control points or nodes of a refit; None = those of the deformer's own lattice.
    strict
        Refuse to lose anything: a refit that is not exact is refused too.

    Returns
    -------
    LossReport
        With the residual of a refit among the losses.

    Raises
    ------
    UnsupportedFormat
        An ending that pliant does not know.
    InvalidParameter
        A refit of a map that has no box of its own, without ``around``.
    LossRefused
        ``strict``, and something would be lost.
    """
    path = Path(path)
    known = transform_format(path)
    if known is None:
        raise UnsupportedFormat(f"{path}: no transform format that pliant writes ({known_endings()})")
    writer = known.load()
    if shape is None and around is None:
        try:
            return writer.write(deformer, path, strict=strict)
        except UnsupportedFormat:
            pass
    found, size = _refitted(deformer, known, around, shape)
    exact = found.largest <= _EXACT * size
    losses = () if exact else (f"the map itself: {found}",)
    refuse_losses(losses, path, strict=strict)
    report = writer.write(found.deformer, path, strict=strict)
    notes = (f"refitted: {found}",) if exact else ()
    return replace(report, losses=losses + report.losses, notes=notes + report.notes)


def direction_note(deformer: SpaceDeformer, path: Path | str) -> tuple[str, ...]:
    """What to say where a map that fetches points goes to a format that moves them, or the other way round."""
    known, own = transform_format(path), getattr(deformer, "direction", None)
    if known is None or own is None or own == known.conventions.direction:
        return ()
    usual = known.conventions.direction
    note = f"the map is {own} and written as it stands; {known.name} takes maps as {usual}: see --inverse"
    return (note,)


def _refitted(
    deformer: SpaceDeformer, known: TransformFormat, around: PolygonMesh | ArrayLike | None, shape: Shape | None
) -> tuple[Refit, float]:
    """The nearest map that the format holds, and the size of the box."""
    kind = known.refit
    own: Shape | None = None
    try:
        region, own = region_of(deformer)
    except InvalidParameter:
        if around is None:
            raise
    if around is not None:
        region = Region.around(around)
    found = refit(deformer, kind, region, shape or _shape(kind, own), edge=known.refit_edge)
    if isinstance(found.deformer, Affine):
        found = replace(found, deformer=replace(found.deformer, direction="pull-back"))
    return found, float(np.linalg.norm(region.edges))


def _shape(kind: Kind, own: Shape | None) -> Shape:
    """Numbers of control points or nodes: the deformer's own, within what suits the kind."""
    least, most, usual = _COUNTS[kind]
    nx, ny, nz = (min(max(n, least), most) for n in own or (usual,) * 3)
    return nx, ny, nz


def inverted(deformer: SpaceDeformer) -> SpaceDeformer:
    """The inverse of a map: of affine maps exactly, of compositions part by part in reverse order.

    Maps that jump at their border go on beyond it, so that they have an inverse there too.
    """
    if isinstance(deformer, Affine):
        return replace(deformer.inverted(), direction=deformer.direction)
    if isinstance(deformer, Composition):
        return compose(*(inverted(part) for part in reversed(deformer.deformers)))
    return Inverse(continued(deformer))
