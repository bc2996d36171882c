"""ITK's transform files as HDF5: ``.h5``, ``.hdf5``."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import MissingExtra, UnreadableFile
from pliant.io.files import write_bytes
from pliant.io.map_formats.itk_parts import Part, deformer_of
from pliant.io.map_formats.itk_writing import parts_of
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import require_usable
from pliant.io.report import LossReport, refuse_losses

NAME = "ITK HDF5"
_GROUP = "TransformGroup"
_MOST_PARTS = 1000
_PER_BYTE = 1100  # numbers compress; beyond this a size is a lie


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file.

    Raises
    ------
    UnreadableFile
        What HDF5 cannot read, or no transform.
    MissingExtra
        h5py is not installed.
    """
    options.require_physical(path)
    h5py = _h5py()
    try:
        with h5py.File(io.BytesIO(data), "r") as stored:
            parts = _parts(path, stored, _PER_BYTE * len(data))
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        cause = " ".join(str(error).split())[:200]
        raise UnreadableFile(path, f"HDF5 cannot read it: {cause}", "the file is cut off or damaged") from error
    return deformer_of(path, parts, NAME)


def _parts(path: Path, stored: Any, most: int) -> list[Part]:
    """The transforms in the order of their numbers."""
    group = stored.get(_GROUP)
    if group is None or not hasattr(group, "keys"):
        raise UnreadableFile(path, f"there is no group {_GROUP!r} in it", "it is no transform file of ITK")
    names = sorted((name for name in group if name.isdecimal()), key=int)
    if len(names) > _MOST_PARTS:
        raise UnreadableFile(path, f"the file holds more than {_MOST_PARTS:,} transforms")
    parts = []
    for name in names:
        place = f"{_GROUP}/{name}"
        if not hasattr(group[name], "keys"):
            raise UnreadableFile(path, f"{place} is no transform", "the file is damaged")
        kind = _text(path, group[name].get("TransformType"), place)
        fixed, values = (_numbers(path, group[name], word, place, most) for word in ("FixedParameters", "Parameters"))
        parts.append(Part(kind, fixed, values, place))
    return parts


def _text(path: Path, stored: Any, place: str) -> str:
    value = None if stored is None else np.asarray(stored[()]).reshape(-1)
    if value is None or len(value) != 1 or not isinstance(value[0], bytes | str):
        raise UnreadableFile(path, f"{place} does not say which kind of transform it is", "the file is damaged")
    return value[0].decode("latin-1") if isinstance(value[0], bytes) else str(value[0])


def _numbers(path: Path, group: Any, word: str, place: str, most: int) -> NDArray[np.float64]:
    """Some parameters; older files spell their name without the first s."""
    stored = group.get(f"Transform{word}", group.get(f"Tranform{word}"))
    if stored is None:
        return np.empty(0)
    if not hasattr(stored, "dtype") or stored.dtype.kind not in "fiu":
        raise UnreadableFile(path, f"{place}: its {word} are no numbers", "the file is damaged")
    if stored.size * stored.dtype.itemsize > most:
        raise UnreadableFile(path, f"{place} claims {stored.size:,} numbers, far more than the file holds")
    return require_usable(path, np.asarray(stored[()]).reshape(-1), place)


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write what ITK has a transform for: affine maps, lattices, linear displacement grids, and compositions.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    h5py = _h5py()
    parts, losses = parts_of(deformer, path)
    refuse_losses(losses, path, strict=strict)
    stream = io.BytesIO()
    with h5py.File(stream, "w") as stored:
        kind = h5py.string_dtype("ascii")
        for name, text in (("ITKVersion", "5.4.0"), ("HDFVersion", h5py.version.hdf5_version), ("OSName", "pliant")):
            stored.create_dataset(name, data=[text], dtype=kind)
        stored.create_dataset("OSVersion", data=["1"], dtype=kind)
        for at, part in enumerate(parts):
            group = stored.create_group(f"{_GROUP}/{at}")
            group.create_dataset("TransformType", data=[part.name], dtype=kind)
            if part.kind != "CompositeTransform":
                group.create_dataset("TransformFixedParameters", data=part.fixed)
                group.create_dataset("TransformParameters", data=part.parameters)
    write_bytes(path, stream.getvalue())
    return LossReport(path, NAME, losses)


def _h5py() -> Any:
    try:
        import h5py
    except ImportError as error:
        raise MissingExtra("reading and writing HDF5", "medical") from error
    return h5py
