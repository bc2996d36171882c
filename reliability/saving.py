"""Saving while being killed, and onto a full disk: `python -m reliability.saving --kills 1000 --full 300`.

A process saves one version after another over the same file, and says when it begins and when it has ended; at a random
moment it is killed. What is found then must be the version that was complete, or the one that was being saved. Where
the disk is full, the error must be pliant's, and the file that was there must be there still, with nothing beside it.
"""

from __future__ import annotations

import argparse
import collections
import os
import random
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from reliability.ledger import Ledger, publish
from reliability.saver import NAMES, save, save_once, save_within, save_without_end, version_of

CONTEXT = get_context("forkserver")
CONTEXT.set_forkserver_preload(["reliability.saver"])


def kill_once(name: str, folder: Path, rng: random.Random) -> dict[str, Any]:
    """Save, kill, look: "old" or "new", or what is wrong."""
    path = folder / name
    save(0, path)
    ours, theirs = CONTEXT.Pipe()
    process = CONTEXT.Process(target=save_without_end, args=(path, theirs))
    process.start()
    theirs.close()
    ours.recv()
    begin = time.monotonic()
    ours.recv()
    time.sleep(rng.uniform(0, 3) * (time.monotonic() - begin))
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    said = ["end", 1]
    try:
        while True:
            said = list(ours.recv())
    except (EOFError, OSError):
        ours.close()
    complete = said[1] if said[0] == "end" else said[1] - 1
    left = [each for each in folder.iterdir() if each.name.startswith(".")]
    for each in left:
        each.unlink()
    try:
        found = version_of(path)
    except Exception as error:
        return {"name": name, "outcome": "lost", "cause": f"{type(error).__name__}: {error}", "amidst": bool(left)}
    outcome = {0: "old", 1: "new"}.get(found - complete, "lost")
    return {"name": name, "outcome": outcome, "amidst": bool(left) or said[0] == "begin"}


def fill_once(name: str, folder: Path, rng: random.Random, *, disk: Path | None = None) -> dict[str, Any]:
    """Save where the room ends somewhere within the file: by a limit, or on a small disk that has been filled."""
    path = (disk or folder) / name
    for each in path.parent.iterdir():
        each.unlink()
    save(0, path)
    before, there = path.read_bytes(), {each.name for each in path.parent.iterdir()} | {"ballast"}
    most = rng.randrange(len(before))
    if disk is not None:
        room = os.statvfs(disk)
        (disk / "ballast").write_bytes(bytes(max(0, room.f_bavail * room.f_frsize - most)))
    ours, theirs = CONTEXT.Pipe()
    target, arguments = (save_once, (path, theirs)) if disk is not None else (save_within, (path, most, theirs))
    process = CONTEXT.Process(target=target, args=arguments)
    process.start()
    theirs.close()
    try:
        said = str(ours.recv())
    except EOFError:
        said = "broken: it ended"
    process.join()
    kept = path.read_bytes() == before
    beside = [each.name for each in path.parent.iterdir() if each.name not in there]
    fine = _holds(path, 1) if said == "saved" else kept and not beside and not said.startswith("broken")
    return {"name": name, "full": "kept" if fine else "lost", "said": said, "kept": kept, "beside": beside}


def _holds(path: Path, version: int) -> bool:
    try:
        return version_of(path) == version
    except Exception:
        return False


@contextmanager
def small_disk(folder: Path, megabytes: int = 4) -> Iterator[Path | None]:
    """A disk in memory; None where nobody may mount one."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    try:
        yield folder if mounted else None
    finally:
        if mounted:
            subprocess.run(["umount", str(folder)], check=True)


def run(kills: int, full: int, ledger: Ledger, seed: int = 0) -> None:
    """Go on from what the ledger holds until there have been so many of each."""
    done = collections.Counter("kill" if "outcome" in entry else "full" for entry in ledger)
    with tempfile.TemporaryDirectory(prefix="pliant-saving-") as place:
        for number in range(done["kill"], kills):
            folder = Path(place, f"{number}")
            folder.mkdir()
            ledger.add(**kill_once(NAMES[number % len(NAMES)], folder, random.Random(f"{seed}/{number}")))
        with small_disk(Path(place, "disk")) as disk:
            for number in range(done["full"], full):
                folder = Path(place, "full")
                folder.mkdir(exist_ok=True)
                small = disk if number // len(NAMES) % 2 else None
                found = fill_once(NAMES[number % len(NAMES)], folder, random.Random(f"{seed}/{number}"), disk=small)
                ledger.add(**found, by="a full disk" if small is not None else "a limit")


def summary(ledger: Ledger) -> dict[str, Any]:
    """The figures of all that a ledger holds."""
    kills = [entry for entry in ledger if "outcome" in entry]
    full = [entry for entry in ledger if "full" in entry]
    rows = []
    for name in NAMES:
        mine = collections.Counter(entry["outcome"] for entry in kills if entry["name"] == name)
        kept = collections.Counter(entry["full"] for entry in full if entry["name"] == name)
        rows.append({"file": name, "killed": sum(mine.values()), "old": mine["old"], "new": mine["new"],
                     "lost": mine["lost"], "no room": sum(kept.values()), "old kept": kept["kept"],
                     "old lost": kept["lost"]})  # fmt: skip
    lost = [entry for entry in [*kills, *full] if "lost" in (entry.get("outcome"), entry.get("full"))]
    return {"kills": len(kills), "amidst a save": sum(entry["amidst"] for entry in kills),
            "files lost by kills": sum(entry["outcome"] == "lost" for entry in kills),
            "saves without room": len(full), "of them on a full disk": sum(e["by"] == "a full disk" for e in full),
            "files lost without room": sum(entry["full"] == "lost" for entry in full), "files": rows,
            "lost": lost[:20]}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--full", type=int, default=300)
    parser.add_argument("--ledger", type=Path, default=Path("saving-ledger.jsonl"))
    options = parser.parse_args()
    ledger = Ledger(options.ledger)
    run(options.kills, options.full, ledger)
    publish("saving", summary(ledger))


if __name__ == "__main__":
    main()
