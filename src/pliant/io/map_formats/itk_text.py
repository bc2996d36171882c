"""ITK's transform files as text: ``.tfm``, ``.txt``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile
from pliant.io.files import write_bytes
from pliant.io.map_formats.itk_parts import Part, deformer_of
from pliant.io.map_formats.itk_writing import parts_of
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import numbers, spaced
from pliant.io.report import LossReport, refuse_losses

NAME = "ITK text"
_MOST_PARTS = 1000


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The map of a file."""
    options.require_physical(path)
    return deformer_of(path, list(_parts(path, data)), NAME)


def _parts(path: Path, data: bytes) -> Iterator[Part]:
    """The transforms in file order."""
    name, begun, found = "", 0, 0
    values = {b"parameters": np.empty(0), b"fixedparameters": np.empty(0)}
    for line, text in enumerate(data.replace(b"\r\n", b"\n").split(b"\n"), start=1):
        key, colon, rest = text.strip().partition(b":")
        if not key or key.startswith(b"#"):
            continue
        key = key.strip().lower()
        if not colon or key not in (b"transform", *values):
            raise UnreadableFile(path, f"{text[:40]!r} is no line of a transform file", "it may be cut off", line=line)
        if key != b"transform":
            values[key] = numbers(path, rest, line, what=key.decode())
            continue
        if name:
            yield Part(name, values[b"fixedparameters"], values[b"parameters"], f"transform {found}", begun)
            values = dict.fromkeys(values, np.empty(0))
            found += 1
        if found > _MOST_PARTS:
            raise UnreadableFile(path, f"the file holds more than {_MOST_PARTS:,} transforms", line=line)
        name, begun = rest.strip().decode("latin-1"), line
    if name:
        yield Part(name, values[b"fixedparameters"], values[b"parameters"], f"transform {found}", begun)


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write what ITK has a transform for: affine maps, lattices, linear displacement grids, and compositions.

    Raises
    ------
    UnsupportedFormat
        Another deformer.
    """
    parts, losses = parts_of(deformer, path)
    refuse_losses(losses, path, strict=strict)
    pieces = [b"#Insight Transform File V1.0\n"]
    for at, part in enumerate(parts):
        pieces.append(b"#Transform %d\nTransform: %s\n" % (at, part.name.encode()))
        if part.kind != "CompositeTransform":
            pieces += [b"Parameters: ", spaced(part.parameters), b"\nFixedParameters: ", spaced(part.fixed), b"\n"]
    write_bytes(path, pieces)
    return LossReport(path, NAME, losses)
