"""Transform files: the two functions that users call."""

from __future__ import annotations

from pathlib import Path

from numpy.typing import ArrayLike

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnsupportedFormat
from pliant.io.files import read_bytes
from pliant.io.map_formats.transform_formats import FORMATS as FORMATS
from pliant.io.map_formats.transform_formats import formats as formats
from pliant.io.map_formats.transform_formats import known_endings
from pliant.io.map_formats.transform_formats import transform_format as transform_format
from pliant.io.map_formats.transform_options import Edge, Placement, ReadOptions, Variant
from pliant.io.report import LossReport
from pliant.mesh import PolygonMesh


def read_transform(
    path: Path | str,
    *,
    placement: Placement = "physical",
    variant: Variant | None = None,
    target: PolygonMesh | None = None,
    edge: Edge = "clamp",
    origin: ArrayLike | None = None,
) -> SpaceDeformer:
    """The map that a transform file describes.

    The file's function is returned as it stands; its ``direction`` says what its owner uses it for. Medical
    transforms are in RAS, millimetres, whatever the file's own convention is.

    Parameters
    ----------
    path
        A file of any format in :data:`FORMATS`.
    placement
        ``"physical"``: the lattice lies where the file says. ``"fit"``: its box is laid around the target's
        bounding box, measured along the lattice's own axes, and the deformation is scaled along each axis with
        the box. Absolute control points (variant C) are not scaled: only the lattice at rest is fitted.
    variant
        The layout of a zxhproj ``.FFD``, where the guess would be wrong: ``"A"`` genuine, ``"B"`` with slabs of
        equal x, ``"C"`` absolute control points of a Bernstein lattice, ``"D"`` one point a line.
    target
        The mesh to fit to.
    edge
        Beyond a B-spline lattice whose file does not say: ``"clamp"`` repeats its outermost control points, ``"zero"``
        takes no displacement there, ``"identity"`` moves nothing where control points are missing.
    origin
        (3,) where control point (0, 0, 0) lies, for a file that does not say; otherwise (0, 0, 0), with a warning.

    Raises
    ------
    UnreadableFile
        The file is not there, truncated or contradicts itself.
    UnsupportedFormat
        No transform format that pliant reads.
    InvalidParameter, InvalidTarget
        A choice that there is not; ``placement="fit"`` without a target, or with a target that has no extent.

    Warns
    -----
    PliantWarning
        Something had to be guessed; the message says what, and how to override it.
    """
    path = Path(path)
    options = ReadOptions(placement, variant, target, edge, origin)
    data = read_bytes(path)
    found = transform_format(path, data)
    if found is None:
        raise UnsupportedFormat(f"{path}: no transform format that pliant reads ({known_endings()})")
    return found.load().read(path, data, options)


def write_transform(deformer: Deformer, path: Path | str, *, strict: bool = False) -> LossReport:
    """Write a deformer to a transform file, whose format its ending tells.

    Parameters
    ----------
    deformer
        The deformer; each format holds some kinds only.
    path
        Where to. An existing file is replaced, at once or not at all.
    strict
        Refuse to write a file that would lose something.

    Raises
    ------
    UnsupportedFormat
        An ending that pliant does not know, or a deformer that the format cannot hold.
    LossRefused
        ``strict``, and something would be lost.
    """
    path = Path(path)
    found = transform_format(path)
    if found is None:
        raise UnsupportedFormat(f"{path}: no transform format that pliant writes ({known_endings()})")
    return found.load().write(deformer, path, strict=strict)
