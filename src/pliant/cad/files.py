"""STEP and IGES files."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import orjson

from pliant.cad.document_writing import document_of
from pliant.cad.kernel import kernel
from pliant.cad.labels import Label, kind_of, labels_of
from pliant.cad.part import Part
from pliant.errors import UnreadableFile, UnsupportedFormat, UnwritableFile
from pliant.io.files import read_bytes, replacing
from pliant.io.mesh_formats.polydata_process import run
from pliant.io.report import LossReport, refuse_losses

_CURE = "export it again, as STEP AP214 or AP242"
_STEP, _IGES = (".step", ".stp"), (".iges", ".igs")


def read(path: Path | str) -> Part:
    """Read a part, with its names, colours, layers and assemblies; lengths become millimetres.

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
    of_kind(path, "STEPCAFControl_Reader", "IGESCAFControl_Reader")
    read_bytes(path)
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        copy = Path(folder, "part.bin")
        run(Path(path), copy, "part", child="pliant.cad.child", reader="Open CASCADE")
        shape = kernel("TopoDS").TopoDS_Shape()
        if not kernel("BinTools").BinTools.Read_s(shape, str(copy)):
            raise UnreadableFile(path, "the kernel finds no shape in it", _CURE)
        said = orjson.loads(copy.with_name("part.bin.json").read_bytes())
    return Part(shape, labels_of(said["labels"]), tuple(said["unkept"]))


def write(part: Part, path: Path | str, *, strict: bool = False) -> LossReport:
    """Write a part, in millimetres, with its names, colours, layers and assemblies.

    Parameters
    ----------
    part
        What to write.
    path
        Ends in ``.step``, ``.stp``, ``.iges`` or ``.igs``.
    strict
        Refuse to write what would lose something.

    Returns
    -------
    LossReport
        What the file that the part was read from says, and this one does not.

    Raises
    ------
    UnsupportedFormat
        The ending is neither STEP's nor IGES's.
    LossRefused
        Something would be lost, and ``strict`` is set; nothing is written.
    UnwritableFile
        The kernel could not write it.
    """
    writer = of_kind(path, "STEPCAFControl_Writer", "IGESCAFControl_Writer")
    is_step = Path(path).suffix.lower() in _STEP
    losses = part.unkept if is_step else (*part.unkept, *_beyond_iges(part.labels))
    refuse_losses(losses, Path(path), strict=strict)
    with silence(), replacing(path) as temporary:
        document = document_of(part.shape, part.labels or (Label(kind_of(part.shape), 0, Path(path).stem),))
        for mode in ("SetNameMode", "SetColorMode", "SetLayerMode"):
            getattr(writer, mode)(True)
        kernel("Interface").Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
        done = writer.Transfer(document.whole)
        written = done and writer.Write(str(temporary))
        if not done or (written != kernel("IFSelect").IFSelect_RetDone if is_step else not written):
            raise UnwritableFile(path, "the kernel refused the part")
    return LossReport(Path(path), "STEP" if is_step else "IGES", losses)


def _beyond_iges(labels: tuple[Label, ...]) -> list[str]:
    """What IGES has no place for: faces have colours without alpha, layers have numbers."""
    counts = {
        "assemblies, as what is mounted into what": sum(label.assembly for label in labels),
        "transparencies": sum(label.color is not None and label.color[3] < 1 for label in labels),
        "names of layers, which become numbers": len({layer for label in labels for layer in label.layers}),
    }
    return [f"{count:,} {what}" for what, count in counts.items() if count]


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
