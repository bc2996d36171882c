"""Which transform formats there are, how their files are recognised, and what each of them means.

A format is one module of this package with ``read(path, data, options)`` and ``write(deformer, path, strict)``, and
one entry below. Modules are imported when a file of theirs turns up.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from pliant.io.gzipped import beginning
from pliant.io.map_formats.transform_format import Conventions, TransformFormat

_HEAD = 4096  # bytes that are enough to tell formats apart

_RAS, _LPS, _OWN = "RAS, mm", "LPS, mm; turned to RAS", "the mesh's own"
_PULL, _PUSH = "pull-back", "push-forward"
_ITK = Conventions(
    "affine maps, B-splines, linear displacement grids, compositions",
    _LPS,
    _PULL,
    "displacements along the world's axes; all x, all y, all z; first index fastest",
    "nothing moves",
    "float64",
)
_FIELD = Conventions(
    "linear displacement grids", _LPS, _PULL, "displacements; x, y, z of a voxel together", "nothing moves", "float64"
)

FORMATS = (
    TransformFormat(
        "zxhproj FFD",
        (".ffd",),
        re.compile(rb"#\s*control grid size"),
        "zxhproj_ffd",
        Conventions(
            "B-splines (variant C, another kind of lattice, is read)",
            _RAS,
            _PULL,
            "displacements along the lattice's axes; x, y, z together; first index fastest",
            "not said: edge=",
            "six decimals",
        ),
        "bspline",
    ),
    TransformFormat(
        "zxhproj AFF",
        (".aff",),
        re.compile(rb"#\s*(matrix|rotation center)"),
        "zxhproj_aff",
        Conventions("affine maps", _RAS, _PULL, "a 4 x 4 matrix, row by row", "–", "six decimals"),
        "affine",
    ),
    TransformFormat(
        "elastix parameters",
        (".0.txt", ".1.txt", ".2.txt", ".3.txt"),
        re.compile(rb"\(\s*Transform(Parameters)?\s"),
        "elastix",
        replace(_ITK, holds="affine maps, B-splines, chains of them (composed or added)"),
        "bspline",
        "identity",
        shared=True,
    ),
    TransformFormat(
        "NiftyReg affine",
        ("affine.txt",),
        re.compile(rb"\A\s*(?:(?:[-+.\deE]+[ \t,]+){3}[-+.\deE]+\s+){3}(?:0(?:\.0*)?[ \t,]+){3}1(?:\.0*)?\s*\Z"),
        "niftyreg_affine",
        Conventions("affine maps", _RAS, _PULL, "a 4 x 4 matrix, row by row", "–", "float64"),
        "affine",
        shared=True,
    ),
    TransformFormat(
        "ITK text",
        (".tfm", ".txt"),
        re.compile(rb"\A\s*#Insight Transform File"),
        "itk_text",
        _ITK,
        "grid",
        shared=True,
    ),
    TransformFormat(
        "ITK HDF5", (".h5", ".hdf5"), re.compile(rb"\A\x89HDF\r\n\x1a\n"), "itk_hdf5", _ITK, "grid", shared=True
    ),
    TransformFormat(
        "NIfTI transform",
        (".nii.gz", ".nii"),
        re.compile(rb"(?s)\A(?:\x5c\x01\x00\x00|\x00\x00\x01\x5c).{46}(?:\x03\x00|\x00\x03).{292}n\+1\x00"),
        "nifti_transforms",
        Conventions(
            "B-splines (NiftyReg); linear displacement grids (ITK, ANTs; NiftyReg's are read)",
            "RAS, mm; ITK's vectors LPS",
            _PULL,
            "positions of control points, or displacements; all x, all y, all z; first index fastest",
            "lattices: not said: edge=; fields: nothing moves",
            "float64; the grid's place float32",
        ),
        "grid",
        shared=True,
    ),
    TransformFormat(
        "MetaImage displacement field",
        (".mha", ".mhd"),
        re.compile(rb"(?s)\A\s*(?:ObjectType\s*=\s*Image|NDims\s*=).*?ElementNumberOfChannels\s*=\s*3\b"),
        "metaimage_field",
        _FIELD,
        "grid",
        shared=True,
    ),
    TransformFormat(
        "VTK displacement field",
        (".vti",),
        re.compile(
            rb"(?s)<VTKFile\b[^>]*type=.ImageData.*?<PointData\b[^>]*Vectors=|DATASET STRUCTURED_POINTS.*?\nVECTORS "
        ),
        "vtk_field",
        Conventions(
            "linear displacement grids",
            "the file's own",
            _PUSH,
            "displacements; x, y, z of a point together; first index fastest",
            "the border goes on",
            "float64",
        ),
        "grid",
        shared=True,
    ),
    TransformFormat(
        "MIRTK dof",
        (".dof.gz", ".dof"),
        re.compile(rb"\A\x00\x0c\x6f\x9f"),
        "mirtk",
        Conventions(
            "affine maps, B-splines, sums of B-splines (MFFD), one after another (fluid)",
            _RAS,
            _PULL,
            "displacements along the world's axes; x, y, z together; first index fastest (types below 50: last)",
            "clamp or zero, as the file says (types below 70: edge=)",
            "float64",
        ),
        "bspline",
    ),
    TransformFormat(
        "PyGeM parameters",
        (".prm",),
        re.compile(rb"(?i)\[\s*box info\s*\]"),
        "pygem",
        Conventions(
            "Bernstein lattices of one patch",
            _OWN,
            _PUSH,
            "displacements along the box's axes, in box lengths; one weight a line",
            "nothing moves",
            "float64",
        ),
        "bernstein",
    ),
    TransformFormat(
        "Plot3D FFD box",
        (".xyz", ".fmt"),
        re.compile(rb"\A\s*1\s*\r?\n\s*\d+\s+\d+\s+\d+\s"),
        "plot3d",
        Conventions(
            "clamped B-splines of order up to 4 in a box; Bernstein lattices of up to 4 control points an axis",
            _OWN,
            _PUSH,
            "positions of control points; all x, all y, all z; first index fastest",
            "nothing moves",
            "float64",
        ),
        "clamped",
        shared=True,
    ),
)


def transform_format(path: Path | str, data: bytes = b"") -> TransformFormat | None:
    """The format of a transform file: by content first, by ending where the content leaves it open.

    Parameters
    ----------
    path
        The file.
    data
        Its beginning, compressed or not; without it the ending decides.
    """
    name, head = Path(path).name.lower(), beginning(data, _HEAD)
    by_content = [known for known in FORMATS if known.signature.search(head)]
    by_ending = [known for known in FORMATS if name.endswith(known.endings)]
    both = [known for known in by_content if known in by_ending]
    by_ending = [known for known in by_ending if not (data and known.shared)]
    return next(iter(both + by_content + by_ending), None)


def formats() -> list[dict[str, str]]:
    """A row for each format: name, endings and conventions, for tables."""
    return [
        {"format": known.name, "endings": ", ".join(f"`{ending}`" for ending in known.endings)}
        | vars(known.conventions)
        for known in FORMATS
    ]


def known_endings() -> str:
    """All endings, for messages."""
    return ", ".join(dict.fromkeys(ending for known in FORMATS for ending in known.endings))
