"""Model files as HDF5."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from pliant.errors import MissingExtra, UnreadableFile
from pliant.io.model_formats.model_tree import Tree, simple

_PER_BYTE = 1100  # numbers compress; beyond this a size is a lie


def from_hdf5(path: Path, data: bytes) -> Tree:
    """The contents of an HDF5 file.

    Raises
    ------
    UnreadableFile
        It is damaged.
    """
    h5py = _h5py()
    tree = Tree()

    def visit(name: str, item: Any) -> None:
        place = f"/{name}"
        if not isinstance(item, h5py.Dataset):
            tree.groups.add(place)
            found = {key: simple(value) for key, value in item.attrs.items()}
            tree.attributes[place] = {key: value for key, value in found.items() if isinstance(value, str)}
        elif item.shape is not None and item.size * item.dtype.itemsize <= _PER_BYTE * len(data):
            value = simple(item[()])
            if value is not None:
                tree.values[place] = value

    try:
        with h5py.File(io.BytesIO(data), "r") as stored:
            stored.visititems(visit)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        cause = " ".join(str(error).split())[:200]
        raise UnreadableFile(path, f"HDF5 cannot read it: {cause}", "the file is cut off or damaged") from error
    return tree


def to_hdf5(tree: Tree) -> bytes:
    """An HDF5 file with scalar strings, as Scalismo expects them."""
    h5py = _h5py()
    stream = io.BytesIO()
    with h5py.File(stream, "w") as stored:
        for place in sorted(tree.groups):
            stored.require_group(place)
        for place, value in tree.values.items():
            stored[place] = np.bytes_(value.encode()) if isinstance(value, str) else value
        for place, words in tree.attributes.items():
            for name, word in words.items():
                stored[place].attrs[name] = np.bytes_(word.encode())
    return stream.getvalue()


def _h5py() -> Any:
    try:
        import h5py
    except ImportError as error:
        raise MissingExtra("reading and writing models as HDF5", "models") from error
    return h5py
