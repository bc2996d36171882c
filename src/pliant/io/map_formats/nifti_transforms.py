"""Transforms in NIfTI files: NiftyReg's control points and deformations, and displacement fields of others.

NiftyReg (intent name ``NREG_TRANS``) stores positions in RAS: of the control points of a cubic B-spline whose lattice
begins one spacing before the image, or of every voxel. Its map takes points of the reference image to the floating
one (pull-back). Other vector images hold displacements: in RAS with intent 1006, in LPS with intent 1007, which is
what ITK and ANTs write.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.image_formats.image import Image
from pliant.io.image_formats.nifti import matrix_of, read_nifti, write_nifti
from pliant.io.image_formats.orientation import split_matrix
from pliant.io.map_formats.anatomy import SIGNS
from pliant.io.map_formats.displacement_images import NOTE, grid_of, image_of_grid
from pliant.io.map_formats.file_facts import FileFacts
from pliant.io.map_formats.lattice_padding import surrounded
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import require_usable
from pliant.io.report import LossReport, refuse_losses
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.displacement_grid import DisplacementGrid

Floats = NDArray[np.float64]

NAME = "NIfTI transform"
_DISPLACEMENTS_RAS, _VECTORS = 1006, 1007
_NIFTYREG = b"NREG_TRANS"
_POSITIONS, _DISPLACEMENTS, _SPLINE = 0, 1, 2
_KINDS = {3: "velocities of voxels", 4: "velocities of voxels", 5: "a velocity lattice", 6: "a linear lattice"}


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file.

    Raises
    ------
    UnreadableFile
        A shape that is no field's, axes that are sheared, numbers that are not finite.
    UnsupportedFormat
        An image that is no transform, or a kind that pliant does not have.
    """
    options.require_physical(path)
    nifti = read_nifti(path, data)
    shape, (code, name, kind) = nifti.values.shape, nifti.intent
    if len(shape) != 5 or shape[3:] != (1, 3) or code not in (_DISPLACEMENTS_RAS, _VECTORS):
        raise UnsupportedFormat(
            f"{path}: an image of {shape} numbers with intent {code} is no transform: (nx, ny, nz, 1, 3) with intent "
            f"{_DISPLACEMENTS_RAS} or {_VECTORS} is one ('pliant warp' deforms images)"
        )
    origin, spacing, axes = split_matrix(path, nifti.matrix)
    image = Image(require_usable(path, nifti.values[:, :, :, 0], "voxels"), origin, spacing, axes)
    if name != _NIFTYREG:
        in_ras = code == _DISPLACEMENTS_RAS
        said = {"vectors": "displacements in RAS" if in_ras else "displacements in LPS, as ITK and ANTs write them"}
        turned = image if in_ras else replace(image, values=image.values * SIGNS)
        return grid_of(turned, path, options, FileFacts(NAME, said))
    if kind == _SPLINE:
        return _spline(path, image, options)
    if kind not in (_POSITIONS, _DISPLACEMENTS):
        what = _KINDS.get(int(kind) if np.isfinite(kind) else -1, f"kind {kind:g}")
        raise UnsupportedFormat(f"{path}: NiftyReg stored {what}; make a deformation field of it with reg_transform")
    facts = FileFacts(NAME, {"vectors": "NiftyReg, " + ("displacements" if kind else "positions") + " in RAS"})
    grid = grid_of(image, path, options, facts)
    if kind == _POSITIONS:
        grid = replace(grid, displacements=image.values - grid.rest)
    return replace(grid, outside="clamp" if options.edge == "clamp" else "identity")


def _spline(path: Path, image: Image, options: ReadOptions) -> BSplineFFD:
    if image.shape[2] == 1:
        raise UnsupportedFormat(f"{path}: NiftyReg's lattice is of the plane; lattices of space are read")
    if min(image.shape) < 4:
        raise UnreadableFile(path, f"a cubic lattice of {image.shape} control points; 4 an axis are needed")
    ffd = BSplineFFD(
        displacements=np.zeros_like(image.values),
        origin=image.origin,
        spacing=image.spacing,
        axes=image.axes,
        edge=options.edge,
        direction="pull-back",
        carrier=FileFacts(NAME, {"vectors": "NiftyReg, positions of control points in RAS"}),
    )
    return ffd.moved(image.values)


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write a B-spline lattice as NiftyReg does, a linear displacement grid as ITK and ANTs do.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    if isinstance(deformer, BSplineFFD):
        return _write_spline(deformer, path, strict=strict)
    if not isinstance(deformer, DisplacementGrid):
        kind = type(deformer).__name__
        raise UnsupportedFormat(
            f"{path}: NIfTI holds a BSplineFFD or a linear DisplacementGrid, not a {kind}: sample it with "
            "pliant.to_grid, or convert it with a refit"
        )
    image, losses, notes = image_of_grid(deformer, path)
    refuse_losses(losses, path, strict=strict)
    vectors = (image.values * SIGNS)[:, :, :, None]
    notes += write_nifti(path, vectors, matrix_of(image), intent=(_VECTORS, b"", 0.0))
    return LossReport(path, NAME, losses, notes)


def _write_spline(ffd: BSplineFFD, path: Path, *, strict: bool) -> LossReport:
    """Positions of the control points; B-splines reproduce the affine part from them."""
    values, origin, _ = surrounded(ffd)
    padded = replace(ffd, displacements=values, origin=origin, edge="clamp", affine=np.eye(4), carrier=None)
    rest = padded.rest
    positions = rest @ ffd.affine[:3, :3].T + ffd.affine[:3, 3] + values
    same = np.array_equal(ffd.affine, np.eye(4))
    losses = () if same else ("the affine part beyond the lattice: within it, the control points hold it",)
    refuse_losses(losses, path, strict=strict)
    notes = [f"what stands beyond the lattice is not stored: pass edge={ffd.edge!r} when reading"]
    notes += [NOTE] if ffd.direction != "pull-back" else []
    image = Image(positions, origin, ffd.spacing, ffd.axes)
    notes += write_nifti(path, positions[:, :, :, None], matrix_of(image), intent=(_VECTORS, _NIFTYREG, float(_SPLINE)))
    return LossReport(path, NAME, losses, tuple(notes))
