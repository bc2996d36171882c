"""Where the stand-alone executable begins: the command line, and the processes that it starts by its own name."""

from __future__ import annotations

import multiprocessing
import os
import runpy
import sys
from pathlib import Path


def main() -> None:
    """Run a reader's process, ``-m pliant.…``, or the command line."""
    multiprocessing.freeze_support()
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pliant" / "kernels"
    os.environ.setdefault("NUMBA_CACHE_DIR", str(cache))  # the folder of the executable may be read-only
    if sys.argv[1:2] == ["-m"] and len(sys.argv) > 2 and sys.argv[2].startswith("pliant."):
        module = sys.argv[2]
        sys.argv = sys.argv[2:]
        runpy.run_module(module, run_name="__main__", alter_sys=True)
        return
    from pliant.cli.__main__ import main as command_line

    command_line()


main()
