"""The contents of a model file, HDF5 or JSON: told apart by the first bytes, whatever the name."""

from __future__ import annotations

from pathlib import Path

from pliant.errors import UnreadableFile
from pliant.io.model_formats.model_tree import Tree

HDF5_START = b"\x89HDF\r\n\x1a\n"


def read_tree(path: Path, data: bytes) -> Tree:
    """The contents of a file; one whose name ends in .h5 may hold JSON.

    Raises
    ------
    UnreadableFile
        Neither, or damaged.
    MissingExtra
        h5py is not installed.
    """
    if data.startswith(HDF5_START):
        from pliant.io.model_formats.model_hdf5 import from_hdf5

        return from_hdf5(path, data)
    if data.lstrip()[:1] == b"{":
        from pliant.io.model_formats.model_json import from_json

        return from_json(path, data)
    raise UnreadableFile(path, "it is neither HDF5 nor JSON", "statismo and Scalismo models are .h5 or .h5.json")
