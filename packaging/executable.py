"""A folder with an executable that needs no Python: `python packaging/executable.py [FOLDER]` builds and tries it.

It needs `pip install pyinstaller` beside `pip install '.[render,studio,shapes,cages,medical,film]'`. The folder runs on
machines like the one that built it. Left out, for their size or licence, is what LEFT_OUT names; commands that need it
say so.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

HERE = Path(__file__).parent
PATIENCE = 1800  # seconds for a command: kernels are compiled, and pictures drawn by software
LEFT_OUT = {
    "OCP": "parts from CAD, under the LGPL",
    "pxr": "USD",
    "alembic3d": "Alembic",
    "imath": "Alembic",
    "ai_edge_litert": "faces from photographs",
    "dask": "clusters",
    "distributed": "clusters",
    "pymeshlab": "alpha wrapping, under the GPL",
    "anywidget": "notebooks",
    "IPython": "notebooks",
    "ipykernel": "notebooks",
    "ipywidgets": "notebooks",
    "jedi": "notebooks",
    "notebook": "notebooks",
    "trame": "other viewers",
    "pandas": "not used",
    "sklearn": "not used",
    "torch": "not used",
    "tkinter": "not used",
    "pytest": "development",
    "mypy": "development",
    "SimpleITK": "development",
    "playwright": "development",
    "splinepy": "development",
    "gustaf": "development",
}


def build(out: Path) -> Path:
    """Run PyInstaller; gives the executable."""
    with tempfile.TemporaryDirectory(prefix="pliant-build-") as work:
        command = [sys.executable, "-m", "PyInstaller", "--noconfirm", "--log-level", "WARN"]
        command += ["--distpath", str(out), "--workpath", work, str(HERE / "pliant.spec")]
        subprocess.run(command, check=True)
    return out / "pliant" / ("pliant.exe" if os.name == "nt" else "pliant")


def try_out(program: Path) -> None:
    """Deform, draw, read through a child process, and open the studio's start page, as a user without Python."""
    with tempfile.TemporaryDirectory(prefix="pliant-try-") as name:
        folder = Path(name)
        home = {"HOME": name, "USERPROFILE": name, "PATH": os.defpath, "SYSTEMROOT": os.environ.get("SYSTEMROOT", "")}
        passed_on = {key: value for key, value in os.environ.items() if key in {"DISPLAY", "OPENBLAS_CORETYPE"}}
        environment = home | passed_on

        def run(*words: str) -> str:
            done = subprocess.run(
                [program, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=PATIENCE
            )
            if done.returncode:
                raise SystemExit(f"pliant {' '.join(words)} ended with {done.returncode}:\n{done.stderr[-3000:]}")
            return done.stdout

        print(run("--version").strip())
        run("demo", "-q")
        made = folder / "pliant-demo"
        run("deform", str(made / "vase.obj"), "--ffd", str(made / "sway.FFD"), "-o", "bent.vtu")
        run("render", "bent.vtu", "-o", "bent.png")
        for path in (made / "after.png", folder / "bent.png"):
            if path.stat().st_size < 20_000:
                raise SystemExit(f"{path.name} is empty")
        start_page(program, folder, environment)


def start_page(program: Path, folder: Path, environment: dict[str, str]) -> None:
    """The studio answers with its page."""
    studio = subprocess.Popen(
        [program, "studio", "--no-browser", "--port", "0"],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        seen, limit = "", time.monotonic() + 120
        while not (found := re.search(r"http://\S+", seen)):
            line = studio.stdout.readline()
            if not line or time.monotonic() > limit:
                raise SystemExit(f"the studio does not start:\n{seen}")
            seen += line
        browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())  # the key is exchanged for a cookie
        with browser.open(found[0], timeout=60) as answer:
            if b"<script" not in answer.read():
                raise SystemExit("the studio's page is empty")
    finally:
        studio.terminate()
        studio.wait(timeout=60)


def size(folder: Path) -> float:
    """Megabytes."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink()) / 2**20


def main() -> None:
    out = Path(sys.argv[1] if len(sys.argv) > 1 else "dist").absolute()
    shutil.rmtree(out / "pliant", ignore_errors=True)
    program = build(out)
    try_out(program)
    print(f"{program.parent}: {size(program.parent):.0f} MB; it deforms, draws, and opens the studio")
    print("left out: " + ", ".join(f"{name} ({why})" for name, why in LEFT_OUT.items() if "not used" not in why))


if __name__ == "__main__":
    main()
