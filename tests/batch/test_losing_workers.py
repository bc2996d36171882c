"""Workers are killed while they work: every outcome comes exactly once, and the bytes are those of a serial run."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import signal
import threading
import time
from concurrent.futures import Future
from pathlib import Path

import numpy as np
import pytest
from distributed import Client, LocalCluster
from distributed.core import Status

import pliant as pl
from pliant.batch.crews import Crew, Pool, crew_of
from pliant.batch.dispatch import outcomes
from pliant.batch.outcome import Job, Outcome
from pliant.batch.parcel import Parcel, sent
from pliant.batch.plans import plan_of
from pliant.examples import vase

# a cluster whose workers were killed leaves sockets that nobody closes
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")


@pytest.fixture
def many(cohort, tmp_path):
    """A hundred and twenty files of twelve shapes."""
    paths = []
    for i in range(120):
        path = tmp_path / "many" / f"{i:03d}.ply"
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(cohort[i % 12].read_bytes())
        paths.append(path)
    return paths


@contextlib.contextmanager
def killer(living, *, seed, times):
    """Now and then, one of the living is killed."""
    random, over, killed = np.random.default_rng(seed), threading.Event(), []

    def work():
        while len(killed) < times and not over.wait(random.uniform(0.05, 0.25)):
            with contextlib.suppress(ProcessLookupError, IndexError, ValueError):
                pid = int(random.choice(living()))
                os.kill(pid, signal.SIGKILL)
                killed.append(pid)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield killed
    finally:
        over.set()
        thread.join()


@pytest.fixture
def cluster():
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with LocalCluster(
        n_workers=3, threads_per_worker=1, dashboard_address=None, silence_logs=logging.CRITICAL
    ) as local:
        yield local
    gc.collect()  # what it leaves is found here, and not in another test


def test_a_cluster_whose_workers_are_killed(cluster, stack, many, serial, tmp_path):
    def living():
        """Who works: a cluster gives up a worker that is killed while it begins."""
        processes = [nanny.process for nanny in cluster.workers.values()]
        return [each.pid for each in processes if each is not None and each.status == Status.running and each.pid]

    with Client(cluster) as client:
        run = pl.run_batch(stack, many, tmp_path / "out" / "{stem}.ply", executor=client)
        found = [next(run)]
        with killer(living, seed=1, times=6) as killed:
            for outcome in run:
                found.append(outcome)
                time.sleep(0.01)  # a slow reader, so that workers die while there is work
    assert killed
    assert sorted(each.index for each in found) == list(range(120))
    assert {each.status for each in found} == {"ok"}, [each.error for each in found if each.error]
    assert all(each.output.read_bytes() == serial[each.index % 12] for each in found)
    assert not [path for path in (tmp_path / "out").iterdir() if path.suffix not in (".ply", ".jsonl")]


def test_what_is_sent_again_is_done_again(cluster, tmp_path):
    """To a cluster, work of the same name is the same work: it would hand over the error of the first time."""
    jobs = [Job(0, tmp_path / "begun", tmp_path / "out")]
    with Client(cluster) as client, crew_of(client, None, 1) as crew:
        crew._work = only_the_second_time
        first = crew.submit(Parcel(b"none"), jobs, False)
        assert isinstance(first.exception(), OSError)
        assert crew.submit(Parcel(b"none"), jobs, False).result() == "done"


def only_the_second_time(parcel, jobs, strict):
    if jobs[0].input.exists():
        return "done"
    jobs[0].input.touch()
    raise OSError("the worker is gone")


def test_a_pool_whose_processes_are_killed(stack, many, serial, tmp_path):
    jobs = [Job(i, path, tmp_path / "out" / path.name) for i, path in enumerate(many)]
    pool = Pool(2)
    found = []
    with (
        sent(plan_of(stack), tmp_path, elsewhere=True) as parcel,
        killer(lambda: list(pool._pool._processes or ()), seed=2, times=3) as killed,
    ):
        for outcome in outcomes(pool, parcel, jobs, strict=False):
            found.append(outcome)
            time.sleep(0.005)
    pool.close()
    assert killed
    assert sorted(each.index for each in found) == list(range(120))
    assert {each.status for each in found} == {"ok"}, [each.error for each in found if each.error]
    assert all(each.output.read_bytes() == serial[each.index % 12] for each in found)


def test_a_mesh_that_kills_its_workers_fails_alone(cohort, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from deadly import Deadly

    shape = vase(240.0, 16, 12)
    pl.write(shape.with_points(shape.points - [0, 0, 300]), cohort[5])
    deformer = Deadly(axis="z", angle=1.0, bounds=(0.0, 240.0))
    found = {each.index: each for each in pl.run_batch(deformer, cohort, tmp_path / "out" / "{stem}.ply", workers=2)}
    assert sorted(found) == list(range(12))
    assert [i for i, each in sorted(found.items()) if each.status == "failed"] == [5]
    assert "cost 3 workers" in found[5].error


class Brittle(Crew):
    """Workers of whom each portion that holds a given job costs one; the others do what they are given."""

    width, elsewhere = 1, True

    def __init__(self, deadly: int) -> None:
        self.deadly, self.portions = deadly, []

    def submit(self, parcel, jobs, strict):
        self.portions.append([job.index for job in jobs])
        future = Future()
        if self.deadly in self.portions[-1]:
            future.set_exception(OSError("the worker is gone"))
        else:
            future.set_result([Outcome(job.index, job.input, job.output, "ok", seconds=1e-3) for job in jobs])
        return future


def test_jobs_that_travel_together_are_tried_one_by_one_when_their_worker_is_lost(tmp_path):
    crew = Brittle(deadly=20)
    jobs = [Job(i, tmp_path / f"{i}.ply", tmp_path / f"out{i}.ply") for i in range(100)]
    found = {each.index: each for each in outcomes(crew, Parcel(b"none"), jobs, strict=False)}
    assert sorted(found) == list(range(100))
    assert [i for i, each in found.items() if each.status == "failed"] == [20]
    lost = next(portion for portion in crew.portions if 20 in portion)
    assert len(crew.portions[0]) == 1 < len(lost) <= 25  # the first goes alone: nobody knows how long a job takes
    assert all([i] in crew.portions for i in lost)
    assert crew.portions.count([20]) == 3
