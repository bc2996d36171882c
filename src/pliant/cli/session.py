"""One run of a command: what it says, what it returns, how it fails.

Progress, warnings and errors go to stderr, results to stdout: as text, or as JSON for machines.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from threading import Timer
from types import TracebackType
from typing import TYPE_CHECKING, Any

import typer

from pliant.cli.exits import exit_code
from pliant.errors import PliantError, PliantWarning

if TYPE_CHECKING:
    from pliant.io.report import LossReport


class Session:
    """A context around a command: prints its result at the end, and one clear line where it fails.

    Parameters
    ----------
    json
        Print the result as JSON on stdout, and an error too.
    quiet
        No progress on stderr; warnings and errors stay.
    """

    def __init__(self, *, json: bool = False, quiet: bool = False) -> None:
        from rich.console import Console

        self._json, self._quiet = json, quiet
        self._stderr = Console(stderr=True, highlight=False, soft_wrap=True)
        self._stdout = Console(highlight=False, soft_wrap=True)
        self._result: dict[str, Any] = {}
        self._warnings: list[str] = []
        self._catcher = warnings.catch_warnings()

    def say(self, line: str) -> None:
        """A line of progress."""
        if not self._quiet:
            self._stderr.print(line, style="dim", markup=False)

    @contextmanager
    def patience(self) -> Iterator[None]:
        """Say why, where what follows takes more than a second."""
        reason = "still at work: the first run on a machine compiles what it needs, and keeps it"
        timer = Timer(1.0, self.say, (reason,))
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def warn(self, line: str) -> None:
        """Something that worked, but not as the user may think."""
        self._warnings.append(line)
        self._stderr.print(f"warning: {line}", style="yellow", markup=False)

    def tell_losses(self, report: LossReport) -> None:
        """Warn of what a written file does not hold, and pass on what its writer notes."""
        for loss in report.losses:
            self.warn(f"{report.path} does not hold: {loss}")
        for note in report.notes:
            self.say(f"note: {note}")

    def result(self, **values: Any) -> None:
        """Values of the result, by name."""
        self._result.update(values)

    def table(self, rows: Mapping[str, str]) -> None:
        """Print names and values for people, on stdout."""
        from rich.text import Text

        if not self._json:
            width = max(map(len, rows), default=0)
            for name, value in rows.items():
                self._stdout.print(Text(f"{name:<{width}}  ", "bold").append(value, "not bold"))

    def __enter__(self) -> Session:
        self._catcher.__enter__()
        warnings.simplefilter("ignore")  # what libraries tell developers is not for users
        warnings.simplefilter("always", PliantWarning)
        warnings.showwarning = lambda message, *_, **__: self.warn(str(message))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._catcher.__exit__(kind, error, traceback)
        if isinstance(error, PliantError | OSError) and not isinstance(error, BrokenPipeError):
            self._fail(error)
        if error is None and self._json:
            self._print_json({**self._result, "warnings": self._warnings})

    def _fail(self, error: PliantError | OSError) -> None:
        code = exit_code(error)
        message = _one_line(error)
        self._stderr.print(f"error: {message}", style="bold red", markup=False)
        if self._json:
            self._print_json({"error": message, "kind": type(error).__name__, "exit_code": int(code)})
        raise typer.Exit(int(code)) from error

    def _print_json(self, values: dict[str, Any]) -> None:
        import orjson

        options = orjson.OPT_INDENT_2 | orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_APPEND_NEWLINE
        sys.stdout.write(orjson.dumps(values, default=str, option=options).decode())


def _one_line(error: PliantError | OSError) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror} (check the path and its permissions)"
    return " ".join(str(error).split())
