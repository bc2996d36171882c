"""Exporting the clip: in the background, with progress, and a way to stop it; with what the format could not hold."""

from __future__ import annotations

import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, PliantError
from pliant.io.report import LossReport
from pliant.scene.animation.formats import endings
from pliant.scene.clip import Clip
from pliant.studio.jobs import Job
from pliant.studio.modes.posing import clip_of
from pliant.studio.request import Request, command
from pliant.studio.serving.files import file_stem
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

FILMS = (".mp4", ".gif")
MOST_PIXELS = 3840
_WITH_UP = (*FILMS, ".usd", ".usda", ".usdc")


class Stopped(PliantError):
    """Somebody has stopped the work."""


@dataclass(frozen=True)
class Written:
    """What an export has made: files by name, and what they do not hold."""

    files: dict[str, NDArray[np.uint8]]
    report: LossReport


@command("export.clip")
def export(session: Session, request: Request) -> Frame:
    """Begin to write the clip in a format; its files come as an event of the page that asked."""
    suffix = request.text("suffix")
    if suffix not in endings():
        raise InvalidParameter(f"no format of animations has the ending {suffix!r}")
    clip, stem = clip_of(session.required), file_stem(session.name)
    options = _options(request, suffix)

    def work(job: Job) -> Written:
        def progress(done: int, count: int) -> None:
            if job.stopped.is_set():
                raise Stopped("stopped")
            session.submit(session.jobs.tell, job, done / count)

        return _written(clip, stem, suffix, progress, options)

    def done(written: Written) -> None:
        report = written.report
        head = {"event": "exported", "files": list(written.files), "losses": report.losses, "notes": report.notes}
        request.client.send(Frame(head, written.files).encode())

    job = session.jobs.run(f"{stem}{suffix}", work, done)
    return Frame({"job": job.name})


def _options(request: Request, suffix: str) -> dict[str, Any]:
    """The options that a format knows."""
    options: dict[str, Any] = {}
    if suffix in _WITH_UP:
        options["up"] = request.text("up", "z")
    if suffix in FILMS:
        size = request.integer("width", 1280), request.integer("height", 720)
        if not all(16 <= each <= MOST_PIXELS for each in size):
            raise InvalidParameter(f"a film may be 16 to {MOST_PIXELS} pixels wide and high; given: {size}")
        options |= {"size": (size[0] // 2 * 2, size[1] // 2 * 2), "turns": request.number("turns", 0.0)}
        options["background"] = request.text("background", "light")
        options["view"] = np.asarray(request.several("view", 3), float) if "view" in request.values else "iso"
    return options


def _written(clip: Clip, stem: str, suffix: str, progress: Any, options: dict[str, Any]) -> Written:
    """The files of a clip; several of them as one archive."""
    with tempfile.TemporaryDirectory(prefix="pliant-export-") as name:
        folder = Path(name)
        report = clip.export(folder / f"{stem}{suffix}", progress=progress, **options)
        paths = sorted(path for path in folder.rglob("*") if path.is_file())
        if len(paths) > 1:
            whole = folder / f"{stem}{suffix}.zip"
            with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
                for path in paths:
                    archive.write(path, path.relative_to(folder).as_posix())
            paths = [whole]
        return Written({path.name: np.frombuffer(path.read_bytes(), np.uint8) for path in paths}, report)
