"""Files that Open CASCADE translates, each in a process forked from one that has imported it: that costs little.

``python -m reliability.forks`` answers each line of JSON, a file and its limits, with what became of the process: its
exit code, what it said, its seconds of the processor and its memory. :func:`run` stands in for the library's own,
which starts a process anew for each file; the module that reads, its limits and its errors are the same.
"""

from __future__ import annotations

import atexit
import json
import os
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from pliant.errors import UnreadableFile
from pliant.io.mesh_formats import polydata_process
from reliability.limits import MEMORY, SECONDS


def run(path: Path, out: Path, _: str, *, child: str, reader: str, name: Path | str | None = None) -> None:
    """As :func:`pliant.io.mesh_formats.polydata_process.run`, in a process that has been forked.

    Raises
    ------
    UnreadableFile
        The module refused the file, or ended.
    MemoryError, TimeoutError
        The process took more than a mutant may.
    """
    assert child == "pliant.cad.child"
    size = path.stat().st_size
    memory, seconds = polydata_process._MEMORY + polydata_process._PER_BYTE * size, polydata_process._SECONDS
    server = _server()
    assert server.stdin is not None
    assert server.stdout is not None
    server.stdin.write(json.dumps([str(path), str(out), memory, seconds]).encode() + b"\n")
    server.stdin.flush()
    code, said, used, most = json.loads(server.stdout.readline())
    if most > MEMORY:
        raise MemoryError(f"a process took {most >> 20} MB")
    if used > SECONDS:
        raise TimeoutError(f"a process took {used:.1f} s of the processor")
    if code:
        done = subprocess.CompletedProcess([child], code, b"", said.encode())
        raise UnreadableFile(name or path, polydata_process._cause(done, reader), "export it again")


@cache
def _server() -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "reliability.forks"]
    server = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    atexit.register(server.communicate)  # it ends with its input
    return server


def main() -> None:
    """Import what reading needs, and fork for each file."""
    from pliant.cad.child import main as translate
    from pliant.cad.kernel import kernel

    for module in ("STEPCAFControl", "IGESCAFControl", "BinTools", "Interface", "IFSelect"):
        kernel(module)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    for line in sys.stdin:
        path, out, memory, seconds = json.loads(line)
        with tempfile.TemporaryFile() as said:
            pid = os.fork()
            if not pid:
                os.dup2(said.fileno(), 2)
                _end_with(translate, path, out, memory, seconds)
            _, status, used = os.wait4(pid, 0)
            said.seek(0)
            told = said.read(1 << 16).decode("utf-8", "replace")
        took = used.ru_utime + used.ru_stime
        print(json.dumps([os.waitstatus_to_exitcode(status), told, took, used.ru_maxrss << 10]), file=answers)


def _end_with(work: Callable[..., int], *arguments: Any) -> NoReturn:
    """Leave this process with what the work gives, as an interpreter would."""
    try:
        code = work(*arguments)
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
