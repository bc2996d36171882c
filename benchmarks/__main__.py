"""Every benchmark, one table: `python -m benchmarks` from the project's root writes it into docs/benchmarks.md.

    python -m benchmarks              # all, in a process each, one after the other; the page is written anew
    python -m benchmarks field face   # these only, shown and not written

A benchmark that fails is a row of the table, and so is a goal that was missed. What stands in the page outside the two
markers is left as it is.
"""

from __future__ import annotations

import datetime
import importlib.metadata
import os
import platform
import re
import subprocess
import sys
import tomllib
from pathlib import Path

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "docs" / "benchmarks.md"
BEGIN, END = "<!-- measured -->", "<!-- /measured -->"
NO_BENCHMARKS = {"__main__", "measure"}
PATIENCE = 3600  # seconds
PEERS = ("vtk", "SimpleITK", "libigl", "splinepy", "trimesh", "meshio", "morphops", "numexpr", "natinterp3d", "dask")
CORE = ("pliant", "numpy", "scipy", "numba")
TABLE = "| task | candidate | ms | ratio |"
NUMBER = re.compile(r"[\d.]+")


def main(names: list[str]) -> int:
    """Run those named, or all; gives an exit code: 1 where one failed."""
    known = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem not in NO_BENCHMARKS)
    unknown = sorted(set(names) - set(known))
    if unknown:
        print(f"no benchmark is called {', '.join(unknown)}; there are: {', '.join(known)}", file=sys.stderr)
        return 2
    goals = tomllib.loads((FOLDER / "goals.toml").read_text(encoding="utf-8"))
    rows, rest, failed = [], [], 0
    for name in names or known:
        print(f"{name} ...", file=sys.stderr, flush=True)
        output, error = run(name)
        compared, other = sorted_out(output)
        rows += [row(name, goals.get(name, {}).get("goals", []), *entry) for entry in compared]
        rest += [f"### {name}.py, in its own words", "", other, ""] if other else []
        if error:
            failed += 1
            rows.append(f"| `{name}.py` | **failed**: {error} | | | | |")
    text = page(names, rows, rest)
    if names:
        print(text)
    else:
        write(text)
    return int(failed > 0)


def run(name: str) -> tuple[str, str]:
    """What a benchmark prints, and the last line of its complaint if it fails."""
    try:
        done = subprocess.run(
            [sys.executable, f"{name}.py"],
            cwd=FOLDER,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            env={**os.environ, "PYTHONWARNINGS": "ignore"},
        )
    except subprocess.TimeoutExpired:
        return "", f"not done after {PATIENCE} s"
    complaint = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return done.stdout, complaint.replace("|", "/") if done.returncode else ""


def sorted_out(output: str) -> tuple[list[tuple[str, str, str, str]], str]:
    """The rows (task, candidate, ms, ratio) of the common table, and all other lines but its heading."""
    _, table, tail = output.partition(TABLE)
    if not table:
        return [], output.strip()
    lines = tail.strip().splitlines()[1:]
    end = next((i for i, line in enumerate(lines) if not line.startswith("|")), len(lines))
    found, task = [], ""
    for line in lines[:end]:
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        task = cells[0] or task
        found.append((task, *cells[1:]))
    return found, "\n".join(lines[end:]).strip()


def row(name: str, goals: list[dict], task: str, candidate: str, ms: str, ratio: str) -> str:
    """A row of the one table, with the goal, and whether it was reached."""
    wanted = [goal for goal in goals if task.startswith(goal["task"]) and candidate.startswith(goal["candidate"])]
    words = ""
    for goal in wanted:
        kind = "ratio" if "ratio" in goal else "ms"
        measured = float(NUMBER.search(ratio if kind == "ratio" else ms)[0])
        reached = measured >= goal["ratio"] if kind == "ratio" else measured <= goal["ms"]
        bound = f"≥ {goal['ratio']}" if kind == "ratio" else f"≤ {goal['ms']} ms"
        words = bound if reached else f"**missed**: {bound}"
    return f"| `{name}.py` | {task} | {candidate} | {ms} | {ratio} | {words} |"


def page(names: list[str], rows: list[str], rest: list[str]) -> str:
    """What stands between the markers."""
    from measure import processor

    versions = ", ".join(f"{name} {installed(name)}" for name in (*CORE, *PEERS))
    missed = sum("**missed**" in each for each in rows)
    failed = sum("**failed**" in each for each in rows)
    return "\n".join(
        [
            "## Measured",
            "",
            f"{datetime.date.today().isoformat()}, `{' '.join(['python -m benchmarks', *names])}`, {processor()},",
            f"Python {platform.python_version()}, {versions}.",
            "Medians (minima) in milliseconds, all candidates in turn in one process; a ratio is to the first one of",
            f"its task, which is faster where it is above 1. Goals missed: {missed}. Benchmarks failed: {failed}.",
            "",
            "| script | task | candidate | ms | ratio | goal |",
            "|---|---|---|--:|--:|---|",
            *rows,
            "",
            *rest,
        ]
    )


def installed(name: str) -> str:
    """A package's version; a peer that is not there has none."""
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def write(text: str) -> None:
    """Put the text between the page's markers."""
    from pliant.io.files import write_bytes

    before, begin, others = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    if not begin or END not in others:
        raise SystemExit(f"{PAGE} lacks the markers {BEGIN} and {END}: put them where the table shall stand")
    after = others.partition(END)[2]
    write_bytes(PAGE, f"{before}{BEGIN}\n{text.rstrip()}\n{END}{after}".encode())


if __name__ == "__main__":
    sys.path.insert(0, str(FOLDER))
    sys.exit(main(sys.argv[1:]))
