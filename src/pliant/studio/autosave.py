"""Unsaved work, kept where it survives: a project file in the user's own folder, and the names of recent files.

It is written on a thread of its own, shortly after a change. A studio that is saved, or closes its document, forgets
it; one that is killed leaves it to the next, which offers it on the start page.
"""

from __future__ import annotations

import os
import time
import uuid
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Lock, Timer

import orjson

from pliant.errors import InvalidParameter, PliantError
from pliant.io.files import write_bytes
from pliant.mesh import PolygonMesh
from pliant.scene.scene import Scene

DELAY = 1.5  # seconds after the last change
_MOST_RECENT = 8
_MOST_KEPT = 10
_MARK = "unsaved-"


def state_folder() -> Path:
    """Where programs keep what they remember of a user."""
    if os.name == "nt":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    else:
        base = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    return base / "pliant" / "studio"


class Autosave:
    """Keeps a studio's unsaved work.

    Parameters
    ----------
    folder
        Where.
    delay
        Seconds from a change to its file.
    """

    def __init__(self, folder: Path, delay: float = DELAY) -> None:
        self.folder, self._delay = folder, delay
        self._own = folder / f"{_MARK}{uuid.uuid4().hex[:12]}.pliant"
        self._waiting: tuple[Scene, str] | None = None
        self._timer: Timer | None = None
        self._lock = Lock()
        self._writer = ThreadPoolExecutor(1, "pliant-autosave")

    def keep(self, scene: Scene, name: str) -> None:
        """Keep a scene, soon."""
        with self._lock:
            self._waiting = scene, name
            if self._timer is None:
                self._timer = Timer(self._delay, self._writer.submit, (self._write,))
                self._timer.daemon = True
                self._timer.start()

    def forget(self) -> None:
        """There is nothing unsaved any more."""
        with self._lock:
            self._waiting = None
        self._writer.submit(_remove, self._own)

    def flush(self) -> None:
        """Write what waits, now."""
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
        self._writer.submit(self._write).result()

    def finish(self) -> None:
        """Write what waits, and end."""
        self.flush()
        self._writer.shutdown(wait=True)

    def recoverable(self) -> list[dict[str, str]]:
        """Unsaved work of studios that ended, the latest first."""
        there = self.folder.glob(f"{_MARK}*.pliant") if self.folder.is_dir() else ()
        found = [(path.stat().st_mtime, path.name) for path in there if path != self._own]
        latest = sorted(found, reverse=True)[:_MOST_KEPT]
        return [{"name": name, "when": time.strftime("%Y-%m-%d %H:%M", time.localtime(when))} for when, name in latest]

    def place(self, name: str) -> Path:
        """Where unsaved work of that name is.

        Raises
        ------
        InvalidParameter
            There is none.
        """
        if name not in [each["name"] for each in self.recoverable()]:
            raise InvalidParameter("this unsaved work is gone")
        return self.folder / name

    def recovered(self, name: str) -> None:
        """Unsaved work is open again: this studio keeps it from now on."""
        _remove(self.folder / name)

    def remember(self, path: Path) -> None:
        """A file has been opened."""
        names = [str(path), *(each for each in self.recent() if each != str(path))][:_MOST_RECENT]
        write_bytes(self.folder / "recent.json", orjson.dumps(names))

    def recent(self) -> list[str]:
        """Files that have been opened, the latest first."""
        try:
            found = orjson.loads((self.folder / "recent.json").read_bytes())
        except (OSError, orjson.JSONDecodeError):
            return []
        return [each for each in found if isinstance(each, str)] if isinstance(found, list) else []

    def _write(self) -> None:
        from pliant.scene.project import save_project

        with self._lock:
            waiting, self._waiting, self._timer = self._waiting, None, None
        if waiting is None:
            return
        scene, _ = waiting
        try:
            save_project(scene.replace(mesh=self._with_textures(scene.mesh)), self._own)
        except (PliantError, OSError):
            _remove(self._own)  # the scene holds what no file can: better nothing than something old

    def _with_textures(self, mesh: PolygonMesh) -> PolygonMesh:
        """The mesh with copies of its textures beside the project, which refers to nothing elsewhere."""
        library = {}
        for name, material in mesh.material_library.items():
            found = material.texture
            if found is not None and found.is_file():
                copy = self.folder / f"{self._own.stem}-{found.name}"
                if not copy.is_file():
                    write_bytes(copy, found.read_bytes())
                material = replace(material, texture=copy)
            library[name] = material
        return mesh.replace(material_library=library)


def _remove(path: Path) -> None:
    """Remove a project, and the textures beside it."""
    for each in (path, *path.parent.glob(f"{path.stem}-*")):
        each.unlink(missing_ok=True)
