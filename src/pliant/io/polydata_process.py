"""Running the process in which another library reads a file, and taking over its arrays."""

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

from pliant.io.format import Source
from pliant.io.polydata_child import CELLS as CELLS

_COLORS = re.compile(r"\x1b\[[\d;]*m")
_MEMORY = 3 << 30  # bytes of address space that VTK takes by itself, with room
_PER_BYTE = 64  # compressed data grows; this much is believed
_SECONDS = 60
_RATE = 1 << 20  # bytes a second that even a slow machine reads


def read(
    source: Source, kind: str = "PolyData", *, child: str = "pliant.io.polydata_child", reader: str = "VTK"
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
    memory = _MEMORY + _PER_BYTE * len(source.data)
    seconds = _SECONDS + len(source.data) // _RATE
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        path, out = Path(folder, "mesh"), Path(folder, "arrays")
        path.write_bytes(source.data)
        limits = [str(memory), str(seconds)]
        command = [sys.executable, "-m", child, str(path), str(out), kind, *limits]
        try:
            done = subprocess.run(command, capture_output=True, timeout=2 * seconds, check=False)  # noqa: S603
        except subprocess.TimeoutExpired as error:
            raise source.unreadable(f"{reader} did not finish within {seconds} s", "the file is damaged") from error
        if done.returncode:
            raise source.unreadable(_cause(done, reader), "the file is cut off or damaged: copy or export it again")
        try:
            with out.open("rb") as stream:
                meta: dict[str, Any] = json.loads(stream.readline())
                return {name: np.load(stream, allow_pickle=False) for name in meta["arrays"]}, meta
        except (OSError, ValueError) as error:
            raise source.unreadable(f"{reader} gave no result", "the file is damaged: export it again") from error


def _cause(done: subprocess.CompletedProcess[bytes], reader: str) -> str:
    """What the library last said, in one line."""
    if done.returncode < 0:
        return f"{reader} crashed on it (signal {-done.returncode})"
    said = _COLORS.sub("", done.stderr.decode("utf-8", "replace")).splitlines()
    errors = [re.split(r"\): |\| ", line)[-1].strip() for line in said if "ERR" in line or "Error" in line]
    return (
        f"{reader} cannot read it: {errors[-1 if reader != 'VTK' else 0][:200]}"
        if errors
        else f"{reader} cannot read it"
    )
