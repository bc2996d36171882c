"""The ledger of a run: what is done, one line a job, so that a run that was cut off goes on where it was."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Any

import orjson

from pliant.batch.outcome import Job, Outcome
from pliant.errors import UnwritableFile
from pliant.scene.keys import key_of

NAME = "pliant-batch.jsonl"


class Ledger:
    """A file of JSON lines, to which outcomes are added as they come.

    Parameters
    ----------
    path
        The file.
    plan
        The key of what the run does.
    resume
        Whether to take what it says as done.

    Raises
    ------
    UnwritableFile
        The system does not let it be written.
    """

    def __init__(self, path: Path, plan: bytes, *, resume: bool) -> None:
        self._path, self._plan = path, plan
        self._lines = _read(path) if resume else {}
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("ab")
            if path.stat().st_size and not path.read_bytes().endswith(b"\n"):
                self._file.write(b"\n")  # an earlier run was cut off within a line
        except OSError as error:
            raise UnwritableFile(path, error.strerror or str(error)) from error

    def __enter__(self) -> Ledger:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._file.close()

    def known(self, job: Job) -> Outcome | None:
        """The outcome of a job that an earlier run did: from the same input, the same way, and still as it was left."""
        line = self._lines.get(self._key(job)) if self._lines else None
        if line is None or line.get("size") != _size(job.output):
            return None
        losses, points = tuple(line.get("losses", ())), int(line.get("points", 0))
        return Outcome(job.index, job.input, job.output, "ok", losses=losses, points=points, resumed=True)

    def add(self, job: Job, outcome: Outcome) -> None:
        """Write an outcome down, for a run that goes on after this one was killed.

        It does not wait for the disk: what a loss of power takes from the end is only done again.

        Raises
        ------
        UnwritableFile
            There is no room for it.
        """
        line = {"job": self._key(job), **vars(outcome), "size": _size(job.output) if outcome.status == "ok" else None}
        del line["resumed"]
        try:
            self._file.write(orjson.dumps(line, default=str, option=orjson.OPT_APPEND_NEWLINE))
            self._file.flush()
        except OSError as error:
            raise UnwritableFile(self._path, error.strerror or str(error)) from error

    def _key(self, job: Job) -> str:
        try:
            state = job.input.stat()
        except OSError:
            return ""
        places = [str(job.input), str(job.output)]
        return key_of(self._plan, places, state.st_size, state.st_mtime_ns, job.controls).hex()


def _read(path: Path) -> dict[str, dict[str, Any]]:
    """The jobs that a ledger says are done; lines that were cut off say nothing."""
    if not path.is_file():
        return {}
    found: dict[str, dict[str, Any]] = {}
    for text in path.read_bytes().splitlines():
        try:
            line = orjson.loads(text)
        except orjson.JSONDecodeError:
            continue
        if isinstance(line, dict) and isinstance(line.get("job"), str) and line["job"]:
            found.pop(line["job"], None)
            if line.get("status") == "ok":
                found[line["job"]] = line
    return found


def _size(path: Path) -> int | None:
    try:
        return path.stat().st_size
    except OSError:
        return None
