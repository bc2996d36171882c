"""Reading and writing shape models: the two functions that users call."""

from __future__ import annotations

from pathlib import Path

from pliant.errors import UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.model_formats.model_files import HDF5_START, read_tree
from pliant.io.model_formats.statismo import losses_of, model_of, tree_of
from pliant.io.report import LossReport, refuse_losses
from pliant.shape.model import ShapeModel

NAME = "statismo 0.9"
ENDINGS = (".h5", ".hdf5", ".h5.json", ".json")


def read_model(path: Path | str, *, prefix: str | None = None) -> ShapeModel:
    """The shape model of a statismo or Scalismo file: HDF5 or HDF5-JSON, whatever its name ends in.

    Parameters
    ----------
    path
        The file.
    prefix
        The group that holds the model, as ``"shape"`` in face models; None = the root, or the only one.

    Raises
    ------
    UnreadableFile
        The file is not there, damaged, holds no model, or several.
    MissingExtra
        h5py, the extra ``models``, is not installed.
    """
    path = Path(path)
    return model_of(read_tree(path, read_bytes(path)), path, prefix)


def write_model(model: ShapeModel, path: Path | str, *, prefix: str = "", strict: bool = False) -> LossReport:
    """Write a shape model as statismo 0.9: ``.h5`` as HDF5, ``.h5.json`` as the HDF5-JSON of newer Scalismo.

    A model that was read and not changed is written with the very numbers that it was read from.

    Parameters
    ----------
    model
        The model. Numbers are kept as float32; a scalar kernel's fields are written once a coordinate.
    path
        Where to; an existing file is replaced once the new one is complete.
    prefix
        A group to put the model into.
    strict
        Refuse to write a file that would lose something.

    Raises
    ------
    UnsupportedFormat
        Another ending.
    LossRefused
        ``strict``, and something would be lost.
    """
    path = Path(path)
    if not path.name.lower().endswith(ENDINGS):
        raise UnsupportedFormat(f"{path}: models are written as .h5 or .h5.json")
    losses = losses_of(model)
    refuse_losses(losses, path, strict=strict)
    tree = tree_of(model, "/" + prefix.strip("/") if prefix.strip("/") else "")
    if path.suffix.lower() == ".json":
        from pliant.io.model_formats.model_json import to_json

        write_bytes(path, to_json(tree))
    else:
        from pliant.io.model_formats.model_hdf5 import to_hdf5

        write_bytes(path, to_hdf5(tree))
    return LossReport(path, NAME, losses, ("numbers are rounded to float32",))


def is_model(path: Path | str) -> bool:
    """Whether a file looks like a shape model."""
    data = read_bytes(path)
    if data.startswith(HDF5_START):
        return b"pcaBasis" in data
    return data.lstrip()[:1] == b"{" and b"/model/pcaBasis" in data
