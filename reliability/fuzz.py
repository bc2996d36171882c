"""Damaged files of every kind against every reader: `python -m reliability.fuzz --count 200000`.

Mutants are made from the corpus by number, so that each can be made again, and read in a process of their own that may
take 10 s of the processor and 1 GiB for each. A run that was cut off goes on where its ledger ends; with `--again` one
mutant is shown.
"""

from __future__ import annotations

import argparse
import collections
import json
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from reliability.ledger import Ledger, publish
from reliability.mutate import mutants
from reliability.readers import FORKED, IN_A_PROCESS, attempt
from reliability.seeds import corpus

SECONDS = 60  # after which a child that says nothing hangs; it counts the seconds of the processor itself
STARTING = 300  # seconds in which a child has imported and compiled what it needs
SLICE = 200
SHARE = 50  # a format that is read in a process of its own gets so many times fewer mutants
FEWER = 3  # and so many times fewer, where that process is forked


@dataclass
class Child:
    """A reading process, started when it is needed and again when it has ended."""

    folder: str
    process: subprocess.Popen[bytes] | None = None
    pending: bytes = b""
    unsound: list[str] = field(default_factory=list)

    def run(self, name: str, start: int, count: int) -> Iterator[dict[str, Any]]:
        """The outcomes of some mutants of a seed; one that hangs or ends the process is one of them."""
        number, stop = start, start + count
        while number < stop:
            self._need()
            self._send({"name": name, "start": number, "count": stop - number})
            while number < stop:
                answer = self._answer(SECONDS)
                yield answer if answer is not None else {"number": number, "outcome": "broken", "kind": self._end()}
                number += 1
                if answer is None:
                    break
                if "leave" in answer:
                    self._end()
                    break

    def end(self) -> None:
        """End the process."""
        if self.process is not None:
            self._end()

    def _need(self) -> None:
        if self.process is None:
            command = [sys.executable, "-m", "reliability.child", self.folder]
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            self.pending = b""
            while "ready" not in (found := self._answer(STARTING) or {"ready": 0}):
                self.unsound.append(json.dumps(found))

    def _send(self, job: dict[str, Any]) -> None:
        assert self.process is not None
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(job).encode() + b"\n")
        self.process.stdin.flush()

    def _answer(self, seconds: float) -> dict[str, Any] | None:
        """The next line; None where the process ended, or did not answer in time."""
        assert self.process is not None
        assert self.process.stdout is not None
        end = time.monotonic() + seconds
        while b"\n" not in self.pending:
            ready, _, _ = select.select([self.process.stdout], [], [], max(0.0, end - time.monotonic()))
            data = self.process.stdout.read1(1 << 16) if ready else b""
            if not data:
                return None
            self.pending += data
        line, _, self.pending = self.pending.partition(b"\n")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _end(self) -> str:
        """End the process, and say what had become of it."""
        process, self.process = self.process, None
        assert process is not None
        try:
            code = process.wait(timeout=1)
            return f"crash: signal {-code}" if code < 0 else f"crash: exit code {code}"
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return f"hang: more than {SECONDS} s"
        finally:
            for stream in (process.stdin, process.stdout):
                if stream is not None:
                    stream.close()


def plan(count: int) -> dict[str, int]:
    """How many mutants each seed gets."""
    names = list(corpus())
    weights = {name: 1 / _share(name) for name in names}
    total = sum(weights.values())
    return {name: max(4, -(-int(count * weight) // int(total))) for name, weight in weights.items()}


def _share(name: str) -> int:
    if name.endswith(FORKED):
        return FEWER
    return SHARE if name.endswith(IN_A_PROCESS) else 1


def run(count: int, ledger: Ledger, seconds: float, only: str = "") -> None:
    """Read mutants until there have been so many, or the time is up."""
    end = time.monotonic() + seconds
    done = collections.Counter(dict.fromkeys(corpus(), 0))
    for entry in ledger:
        done[entry["name"]] = max(done[entry["name"]], entry["start"] + entry["count"])
    wanted = plan(count)
    with tempfile.TemporaryDirectory(prefix="pliant-fuzz-") as folder:
        child = Child(folder)
        try:
            while time.monotonic() < end:
                left = {name: done[name] / goal for name, goal in wanted.items() if done[name] < goal and only in name}
                if not left:
                    break
                name = min(left, key=lambda each: left[each])
                size = min(SLICE if wanted[name] > 4 * SLICE else 4, wanted[name] - done[name])
                _slice(child, ledger, name, done[name], size)
                done[name] += size
        finally:
            child.end()
    for line in child.unsound:
        print("a seed is not read:", line)


def _slice(child: Child, ledger: Ledger, name: str, start: int, count: int) -> None:
    begin, outcomes, findings = time.monotonic(), collections.Counter[str](), []
    for answer in child.run(name, start, count):
        outcomes[answer["outcome"]] += 1
        if answer["outcome"] == "broken":
            findings.append(answer)
    ledger.add(
        name=name, start=start, count=count, seconds=round(time.monotonic() - begin, 2), **outcomes, findings=findings
    )


def summary(ledger: Ledger) -> dict[str, Any]:
    """The figures of all that a ledger holds."""
    total: collections.Counter[str] = collections.Counter()
    by_kind: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    causes: dict[str, list[str]] = collections.defaultdict(list)
    for entry in ledger:
        for name in ("count", "accepted", "refused", "broken"):
            total[name] += entry.get(name, 0)
            by_kind[entry["name"].partition("/")[0]][name] += entry.get(name, 0)
        total["seconds"] += int(entry["seconds"])
        for finding in entry["findings"]:
            causes[finding["kind"]].append(f"{entry['name']} {finding['number']}")
    findings = [{"cause": kind, "mutants": len(where), "first": where[0]} for kind, where in sorted(causes.items())]
    kinds = [{"kind": kind, "mutants": each["count"], "accepted": each["accepted"], "refused": each["refused"],
              "broken": each["broken"]} for kind, each in sorted(by_kind.items())]  # fmt: skip
    return {"mutants": total["count"], "accepted": total["accepted"], "refused": total["refused"],
            "broken": total["broken"], "hours": round(total["seconds"] / 3600, 2), "kinds": kinds,
            "findings": findings}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200_000)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="stop after so long")
    parser.add_argument("--ledger", type=Path, default=Path("fuzz-ledger.jsonl"))
    parser.add_argument("--only", default="", help="seeds whose names hold this")
    parser.add_argument("--again", nargs=2, metavar=("SEED", "NUMBER"), help="read one mutant here, and show it")
    options = parser.parse_args()
    if options.again:
        name, number = options.again[0], int(options.again[1])
        (data,) = mutants(corpus()[name], list(corpus().values()), 1, name, number)
        print(data[:3000])
        with tempfile.TemporaryDirectory() as folder:
            print(attempt(name, data, Path(folder)))
        return
    ledger = Ledger(options.ledger)
    run(options.count, ledger, options.seconds, options.only)
    publish("fuzz", summary(ledger))


if __name__ == "__main__":
    main()
