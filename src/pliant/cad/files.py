"""STEP and IGES files."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pliant.cad.kernel import kernel
from pliant.cad.part import Part
from pliant.errors import UnreadableFile, UnsupportedFormat, UnwritableFile
from pliant.io.files import read_bytes, replacing
from pliant.io.mesh_formats.polydata_process import run

_CURE = "export it again, as STEP AP214 or AP242"
_STEP, _IGES = (".step", ".stp"), (".iges", ".igs")


def read(path: Path | str) -> Part:
    """Read a part; lengths become millimetres.

    Parameters
    ----------
    path
        A STEP or IGES file.

    Raises
    ------
    UnreadableFile
        The file is not there, or holds no shape.
    UnsupportedFormat
        It is neither STEP nor IGES.
    MissingExtra
        Open CASCADE is not installed.
    """
    of_kind(path, "STEPControl_Reader", "IGESControl_Reader")
    read_bytes(path)
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        copy = Path(folder, "part.bin")
        run(Path(path), copy, "part", child="pliant.cad.child", reader="Open CASCADE")
        shape = kernel("TopoDS").TopoDS_Shape()
        if not kernel("BinTools").BinTools.Read_s(shape, str(copy)):
            raise UnreadableFile(path, "the kernel finds no shape in it", _CURE)
    return Part(shape)


def write(part: Part, path: Path | str) -> None:
    """Write a part, in millimetres.

    Parameters
    ----------
    part
        What to write.
    path
        Ends in ``.step``, ``.stp``, ``.iges`` or ``.igs``.

    Raises
    ------
    UnsupportedFormat
        The ending is neither STEP's nor IGES's.
    UnwritableFile
        The kernel could not write it.
    """
    writer = of_kind(path, "STEPControl_Writer", "IGESControl_Writer")
    with silence(), replacing(path) as temporary:
        if Path(path).suffix.lower() in _STEP:
            writer.Transfer(part.shape, kernel("STEPControl").STEPControl_AsIs)
            done = writer.Write(str(temporary)) == kernel("IFSelect").IFSelect_RetDone
        else:
            done = writer.AddShape(part.shape) and writer.Write(str(temporary))
        if not done:
            raise UnwritableFile(path, "the kernel refused the part")


def of_kind(path: Path | str, step: str, iges: str) -> Any:
    """A reader or writer of the kernel, by the ending of a file."""
    suffix = Path(path).suffix.lower()
    if suffix not in (*_STEP, *_IGES):
        raise UnsupportedFormat(f"{path}: parts are STEP ({', '.join(_STEP)}) or IGES ({', '.join(_IGES)})")
    name = step if suffix in _STEP else iges
    return getattr(kernel(name.split("_")[0]), name)()


@contextmanager
def silence() -> Iterator[None]:
    """Keep the kernel from printing what it does."""
    messenger = kernel("Message").Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)
