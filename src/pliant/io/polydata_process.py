"""Running the process that reads VTK files, and taking over its arrays."""

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


def read(source: Source, kind: str = "PolyData") -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """The arrays of a VTK file, and the names that they have.

    Parameters
    ----------
    source
        The file.
    kind
        What it holds, by the name that VTK's classes have.

    Raises
    ------
    UnreadableFile
        VTK complained, crashed, or went beyond its share of memory or time.
    """
    memory = _MEMORY + _PER_BYTE * len(source.data)
    seconds = _SECONDS + len(source.data) // _RATE
    with tempfile.TemporaryDirectory(prefix="pliant-") as folder:
        path, out = Path(folder, "mesh"), Path(folder, "arrays")
        path.write_bytes(source.data)
        limits = [str(memory), str(seconds)]
        command = [sys.executable, "-m", "pliant.io.polydata_child", str(path), str(out), kind, *limits]
        try:
            done = subprocess.run(command, capture_output=True, timeout=2 * seconds, check=False)  # noqa: S603
        except subprocess.TimeoutExpired as error:
            raise source.unreadable(f"VTK did not finish within {seconds} s", "the file is damaged") from error
        if done.returncode:
            raise source.unreadable(_cause(done), "the file is cut off or damaged: copy or export it again")
        try:
            with out.open("rb") as stream:
                meta: dict[str, Any] = json.loads(stream.readline())
                return {name: np.load(stream, allow_pickle=False) for name in meta["arrays"]}, meta
        except (OSError, ValueError) as error:
            raise source.unreadable("VTK gave no result", "the file is damaged: export it again") from error


def _cause(done: subprocess.CompletedProcess[bytes]) -> str:
    """What VTK last said, in one line."""
    if done.returncode < 0:
        return f"VTK crashed on it (signal {-done.returncode})"
    said = _COLORS.sub("", done.stderr.decode("utf-8", "replace")).splitlines()
    errors = [re.split(r"\): |\| ", line)[-1].strip() for line in said if "ERR" in line or "Error" in line]
    return f"VTK cannot read it: {errors[0][:200]}" if errors else "VTK cannot read it"
