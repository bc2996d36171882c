"""Running the process in which another library reads a file, and taking over its arrays.

Libraries that were not written against damaged files crash on them, or take all memory: they do so there.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.mesh_formats.format import Source
from pliant.io.mesh_formats.polydata_child import CELLS as CELLS

_COLORS = re.compile(r"\x1b\[[\d;]*m")
_MEMORY = 3 << 30  # bytes of address space that VTK takes by itself, with room
_PER_BYTE = 64  # compressed data grows; this much is believed
_SECONDS = 8  # of the processor, beside what the size of a file explains
_RATE = 1 << 16  # bytes a second that even a slow library reads


def read(
    source: Source, kind: str = "PolyData", *, child: str = "pliant.io.mesh_formats.polydata_child", reader: str = "VTK"
) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """The arrays of a file that another library reads, and the names that they have.

    Parameters
    ----------
    source
        The file.
    kind
        What it holds, by the name that VTK's classes have.
    child
        The module that the process runs.
    reader
        What that library is called in errors.

    Raises
    ------
    UnreadableFile
        The library complained, crashed, or went beyond its share of memory or time.
    """
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        path = Path(folder, "mesh")
        path.write_bytes(source.data)
        return read_path(path, kind, child=child, reader=reader, name=source.name)


def read_path(
    path: Path, kind: str, *, child: str, reader: str, name: Path | str | None = None
) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """As :func:`read`, for a file that stays where it is, as those do that refer to others beside them.

    Raises
    ------
    UnreadableFile
        As :func:`read`; or there is no such file.
    """
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        out = Path(folder, "arrays")
        run(path, out, kind, child=child, reader=reader, name=name)
        try:
            with out.open("rb") as stream:
                meta: dict[str, Any] = json.loads(stream.readline())
                return {name: np.load(stream, allow_pickle=False) for name in meta["arrays"]}, meta
        except (OSError, ValueError) as error:
            raise UnreadableFile(
                name or path, f"{reader} gave no result", "the file is damaged: export it again"
            ) from error


def run(path: Path, out: Path, kind: str, *, child: str, reader: str, name: Path | str | None = None) -> None:
    """Have a module read a file, in a process of its own and within limits, and write another file.

    Parameters
    ----------
    path, out
        What it reads, and what it writes.
    kind
        Words for the module.
    child
        The module, called as ``python -m child PATH OUT KIND BYTES SECONDS``.
    reader
        What the library that it uses is called in errors.
    name
        What the file is called in errors; None = its path.

    Raises
    ------
    UnreadableFile
        As :func:`read_path`.
    """
    told = name or path
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        raise UnreadableFile(told, "there is no such file", "check the path") from error
    memory, seconds = _MEMORY + _PER_BYTE * size, _SECONDS + size // _RATE
    command = [sys.executable, "-m", child, str(path), str(out), kind, str(memory), str(seconds)]
    try:
        done = subprocess.run(command, capture_output=True, timeout=5 * seconds, check=False)  # noqa: S603
    except subprocess.TimeoutExpired as error:
        raise UnreadableFile(told, f"{reader} did not finish within {seconds} s", "the file is damaged") from error
    if done.returncode:
        raise UnreadableFile(told, _cause(done, reader), "the file is cut off or damaged: copy or export it again")


def _cause(done: subprocess.CompletedProcess[bytes], reader: str) -> str:
    """What the library last said, in one line."""
    if done.returncode < 0:
        return f"{reader} crashed on it (signal {-done.returncode})"
    said = _COLORS.sub("", done.stderr.decode("utf-8", "replace")).splitlines()
    errors = [
        re.split(r"\): |\| ", line)[-1].strip().removeprefix("Error: ")
        for line in said
        if "ERR" in line or "Error" in line
    ]
    return (
        f"{reader} cannot read it: {errors[-1 if reader != 'VTK' else 0][:200]}"
        if errors
        else f"{reader} cannot read it"
    )
