"""Timing in one run: candidates in turn, medians and ratios, and the table that the documentation shows."""

from __future__ import annotations

import datetime
import importlib.metadata
import platform
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Comparison:
    """One task, done by pliant and by its peers."""

    task: str
    candidates: dict[str, Callable[[], object]]
    rounds: int = 7
    repeat: int = 1  # consecutive calls in a round, as in an interaction
    seconds: dict[str, list[float]] = field(default_factory=dict)

    def run(self) -> Comparison:
        for work in self.candidates.values():
            work()  # compile, load, warm the caches
        self.seconds = {name: [] for name in self.candidates}
        for _ in range(self.rounds):
            for name, work in self.candidates.items():
                start = time.perf_counter()
                for _ in range(self.repeat):
                    work()
                self.seconds[name].append((time.perf_counter() - start) / self.repeat)
        return self

    def rows(self) -> list[str]:
        medians = {name: statistics.median(times) for name, times in self.seconds.items()}
        ours = next(iter(medians.values()))
        return [
            f"| {self.task if i == 0 else ''} | {name} | {1e3 * median:.1f} ({1e3 * min(self.seconds[name]):.1f}) | "
            + ("1 |" if i == 0 else f"{median / ours:.1f} |")
            for i, (name, median) in enumerate(medians.items())
        ]


def report(title: str, comparisons: list[Comparison], packages: list[str], notes: list[str] | None = None) -> str:
    """A Markdown table, with what is needed to judge it; the first candidate of each task is the unit of the ratio."""
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in packages)
    command = "python " + " ".join([Path(sys.argv[0]).name, *sys.argv[1:]])
    lines = [
        f"## {title}",
        "",
        f"{datetime.date.today().isoformat()}, `{command}`, {processor()},",
        f"Python {platform.python_version()}, {versions}.",
        "Medians (minima) in milliseconds, all candidates in turn in one process; ratio to the first of each task.",
        "",
        "| task | candidate | ms | ratio |",
        "|---|---|--:|--:|",
        *(row for comparison in comparisons for row in comparison.run().rows()),
        "",
        *(notes or []),
    ]
    return "\n".join(lines)


def processor() -> str:
    """The machine, as far as it matters."""
    from pliant.numerics.compute.chunks import processors

    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        model = platform.processor() or platform.machine()
    return f"{model}, {processors()} processors, shared"
