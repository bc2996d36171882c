"""A batch on a cluster whose workers are killed: `python -m reliability.losing --jobs 2000 --kills 40`.

Every job must have exactly one outcome, and the files must be those of a serial run, bit by bit. A batch that is cut
off, workers and all, goes on by its own ledger: the second half is asked for by a new cluster.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import itertools
import logging
import os
import random
import signal
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from distributed import Client, LocalCluster

import pliant as pl
from pliant.examples import vase
from reliability.ledger import publish


def cohort(folder: Path, count: int) -> list[Path]:
    """So many meshes, no two alike."""
    paths = [folder / f"{i:05d}.ply" for i in range(count)]
    for i, path in enumerate(paths):
        pl.write(vase(200.0 + 0.01 * i, 16, 12), path)
    return paths


def deformation() -> pl.Stack:
    """A twist, a lattice, half a bend."""
    shape = vase(240.0, 16, 12)
    ffd = pl.BSplineFFD.around(shape, shape=(4, 4, 4))
    moved = ffd.moved(ffd.rest + np.random.default_rng(3).normal(size=ffd.rest.shape))
    twist = pl.Twist.around(shape, axis="z", angle=1.0)
    bend = pl.Bend.around(shape, axis="y", angle=0.3, normal="z")
    return pl.Stack([pl.Layer("twist", twist), pl.Layer("lattice", moved), pl.Layer("bend", bend, envelope=0.5)])


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[tuple[LocalCluster, Client]]:
    """A cluster of processes on this machine."""
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with (
        LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=logging.CRITICAL
        ) as local,
        Client(local) as client,
    ):
        yield local, client


def kill_one(local: LocalCluster, rng: random.Random, killed: dict[Any, str]) -> bool:
    """Kill a worker that works; False where none does just now: one that dies while it starts is never replaced.

    A nanny's worker has started anew when its address is another one than that of the worker that was killed before.
    """
    known = set(local.scheduler_info["workers"])
    living = [
        each
        for each in local.workers.values()
        if each.worker_address in known and each.process is not None and each.worker_address != killed.get(each.id)
    ]
    if not living:
        return False
    nanny = rng.choice(living)
    killed[nanny.id] = nanny.worker_address
    with contextlib.suppress(ProcessLookupError, TypeError):
        os.kill(nanny.process.pid, signal.SIGKILL)
        return True
    return False


def figures(jobs: int, kills: int, workers: int = 2, seed: int = 0) -> dict[str, Any]:
    """Run a batch serially and on clusters that lose workers, and compare."""
    rng, stack = random.Random(seed), deformation()
    with tempfile.TemporaryDirectory(prefix="pliant-losing-") as place:
        folder = Path(place)
        (folder / "in").mkdir()
        paths = cohort(folder / "in", jobs)
        begin = time.monotonic()
        serial = list(pl.run_batch(stack, paths, folder / "serial" / "{stem}.ply", workers=0))
        alone, killed, begin = time.monotonic() - begin, 0, time.monotonic()
        moments = sorted(rng.sample(range(1, jobs), min(kills, jobs - 1)))
        found, half, resumed, dead = [], jobs // 2, 0, dict[Any, str]()
        with cluster(workers) as (local, client):
            run = pl.run_batch(stack, paths, folder / "out" / "{stem}.ply", executor=client)
            for number, outcome in enumerate(itertools.islice(run, half)):
                found.append(outcome)
                killed += number in moments and kill_one(local, rng, dead)
            run.close()  # the cluster goes with its work half done
        with cluster(workers) as (local, client):
            run = pl.run_batch(stack, paths, folder / "out" / "{stem}.ply", executor=client, resume=True)
            rest = []
            for outcome in run:
                rest.append(outcome)
                resumed += outcome.resumed
                if not outcome.resumed:
                    killed += half + len(rest) - resumed in moments and kill_one(local, rng, dead)
        seconds = time.monotonic() - begin
        times = collections.Counter(outcome.index for outcome in rest)
        same = sum(_same(folder / "serial" / path.name, folder / "out" / path.name) for path in paths)
        left = [each.name for each in (folder / "out").iterdir() if each.suffix not in (".ply", ".jsonl")]
    return {
        "jobs": jobs,
        "workers": workers,
        "workers killed": killed,
        "done before the cluster was shut down": len(found),
        "of them taken over by the next": resumed,
        "jobs with exactly one outcome": sum(times[i] == 1 for i in range(jobs)),
        "failed outcomes": sum(outcome.status != "ok" for outcome in rest),
        "files as of the serial run": same,
        "files left over": len(left),
        "serial s": round(alone, 1),
        "clusters s": round(seconds, 1),
        "serial failures": sum(outcome.status != "ok" for outcome in serial),
        "failures": [{"job": each.index, "error": each.error} for each in rest if each.status != "ok"][:20],
    }


def _same(one: Path, two: Path) -> bool:
    return two.exists() and one.read_bytes() == two.read_bytes()


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=2000)
    parser.add_argument("--kills", type=int, default=40)
    options = parser.parse_args()
    publish("losing", figures(options.jobs, options.kills))


if __name__ == "__main__":
    main()
