"""What a run has done so far, in a file of lines that a killed run leaves sound; and its figures."""

from __future__ import annotations

import datetime
import json
import os
import platform
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FIGURES = Path(__file__).with_name("figures")


@dataclass(frozen=True)
class Ledger:
    """Lines of JSON, appended.

    Parameters
    ----------
    path
        The file.
    """

    path: Path

    def add(self, **entry: Any) -> None:
        """Append a line."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a") as stream:
            stream.write(json.dumps(entry) + "\n")

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """The entries; a line that was cut off is passed over."""
        for line in self.path.read_text().splitlines() if self.path.exists() else ():
            try:
                yield json.loads(line)
            except ValueError:
                continue


def circumstances() -> dict[str, Any]:
    """What is needed to judge a figure: day, command, machine, how busy that was."""
    module = Path(sys.argv[0]).stem
    return {
        "date": datetime.date.today().isoformat(),
        "command": " ".join(["python -m", f"reliability.{module}", *_plain(sys.argv[1:])]),
        "python": platform.python_version(),
        "processors": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1),
    }


def _plain(arguments: list[str]) -> list[str]:
    """Without where the ledger was: that is no part of what was done."""
    at = arguments.index("--ledger") if "--ledger" in arguments else len(arguments)
    return arguments[:at] + arguments[at + 2 :]


def publish(name: str, figures: dict[str, Any], folder: Path = FIGURES) -> None:
    """Write figures for machines, and print them for people."""
    folder.mkdir(parents=True, exist_ok=True)
    whole = {**circumstances(), **figures}
    (folder / f"{name}.json").write_text(json.dumps(whole, indent=2) + "\n")
    print(table(whole))


def table(figures: dict[str, Any]) -> str:
    """Figures as a Markdown table; lists of records as tables below it."""
    lines = ["| figure | value |", "|---|--:|"]
    lines += [f"| {name} | {_shown(value)} |" for name, value in figures.items() if not isinstance(value, list)]
    for name, rows in figures.items():
        if isinstance(rows, list) and rows:
            heads = list(rows[0])
            lines += ["", f"**{name}**", "", f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
            lines += [f"| {' | '.join(_shown(row.get(head)) for head in heads)} |" for row in rows]
    return "\n".join(lines)


def _shown(value: Any) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "–"}[value]
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:.3g}" if isinstance(value, float) else str(value)
