"""Batches against plain loops: `python benchmarks/batch.py`."""

from __future__ import annotations

import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster

import pliant as pl
from measure import Comparison, report
from pliant.cages.boxes import cage_from_box
from pliant.examples import vase

FOLDER = Path(tempfile.gettempdir()) / "pliant-benchmark-batch"
CONTEXT = get_context("spawn")
SMALL, TINY = 1000, 300  # files


def files(name: str, count: int, different: int, around: int, along: int) -> list[Path]:
    """So many files, of so many different vases."""
    paths = []
    for i in range(count):
        path = FOLDER / name / f"{i:04d}.ply"
        path.parent.mkdir(parents=True, exist_ok=True)
        pl.write(vase(200.0 + i % different, around, along), path)
        paths.append(path)
    return paths


def emptied() -> Path:
    """Where results are written, with nothing in it: replacing a file waits for the disk, which is another question."""
    shutil.rmtree(FOLDER / "out", ignore_errors=True)
    (FOLDER / "out").mkdir(parents=True)
    return FOLDER / "out"


def batch(deformation, paths: list[Path], **options) -> Callable[[], None]:
    def work() -> None:
        found = list(pl.run_batch(deformation, paths, emptied() / "{stem}-{index}.ply", **options))
        assert all(each.status == "ok" for each in found), found[0].error

    return work


def loop(deformers, paths: list[Path]) -> Callable[[], None]:
    def work() -> None:
        folder = emptied()
        for i, (deformer, path) in enumerate(zip(deformers, paths, strict=True)):
            pl.write(deformer(pl.read(path)), folder / f"{path.stem}-{i}.ply")

    return work


def scaling(one: ProcessPoolExecutor, two: ProcessPoolExecutor) -> list[Comparison]:
    """Files on two processes and on one; and what the machine itself gives to two that do nothing but count."""
    paths = files("large", 24, 24, 200, 100)
    shape = pl.read(paths[0])
    ffd = pl.BSplineFFD.around(shape, shape=(8, 8, 8))
    stack = pl.Stack([pl.Layer("ffd", ffd.moved(ffd.rest + 3.0)), pl.Layer("cage", posed(shape, 1)[0])])
    return [
        Comparison(
            f"24 files of {thousands(paths[0])} points, a lattice and a cage",
            {"two processes": batch(stack, paths, executor=two), "one process": batch(stack, paths, executor=one)},
            rounds=5,
        ),
        Comparison(
            "two processes that only count: what the machine allows",
            {
                "two processes": lambda: list(two.map(count, range(8))),
                "one process": lambda: list(one.map(count, range(8))),
            },
            rounds=5,
        ),
    ]


def count(_: int) -> int:
    """Work for one processor, without memory to speak of."""
    return sum(number & 3 for number in range(2_000_000))


def thousands(path: Path) -> str:
    return f"{len(pl.read(path).points) / 1e3:.1f}k"


def posed(shape: pl.PolygonMesh, count: int) -> list[pl.Cage]:
    """A cage around a shape, and as many poses of it."""
    cage = pl.Cage(cage_from_box(shape, (4, 4, 4)))
    size = 0.03 * shape.diagonal
    poses = np.random.default_rng(0).normal(size=(count, *cage.rest.shape)) * size
    return [cage.moved(cage.rest + pose) for pose in poses]


def binding(two: ProcessPoolExecutor) -> list[Comparison]:
    """A thousand small files, against a loop that binds each anew."""
    found = []
    for different, words in ((1, "of one shape, each posed its own way"), (SMALL, "of as many shapes, one pose")):
        paths = files(f"small{different}", SMALL, different, 40, 30)
        cages = posed(pl.read(paths[0]), SMALL) if different == 1 else posed(pl.read(paths[0]), 1) * SMALL
        tasks = [cage.controls for cage in cages]
        ways = {
            "two processes": batch(cages[0], paths, controls=tasks, executor=two),
            "this process": batch(cages[0], paths, controls=tasks, workers=0),
            "a loop that binds each": loop(cages, paths),
        }
        found.append(Comparison(f"{SMALL:,} files of {thousands(paths[0])} points {words}, a cage", ways, rounds=3))
    return found


def overhead(two: ProcessPoolExecutor, client: Client) -> list[str]:
    """Milliseconds a job beside reading, deforming and writing."""
    paths = files("tiny", TINY, TINY, 8, 6)
    twist = pl.Twist.around(pl.read(paths[0]), axis="z", angle=1.0)
    ways = {
        "this process": batch(twist, paths, workers=0),
        "a pool": batch(twist, paths, executor=two),
        "a Dask cluster": batch(twist, paths, executor=client),
    }
    plain, found = loop([twist] * TINY, paths), {}
    for name, work in ways.items():
        pairs = [(clock(work), clock(plain)) for _ in range(3)]
        found[name] = statistics.median(ours - theirs for ours, theirs in pairs) / TINY * 1e3
    told = ", ".join(f"{name} {value:+.2f} ms" for name, value in found.items())
    return [f"Overhead a job, beside a plain loop in one process that reads, deforms and writes: {told}."]


def clock(work: Callable[[], None]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main() -> None:
    with (
        ProcessPoolExecutor(1, CONTEXT) as one,
        ProcessPoolExecutor(2, CONTEXT) as two,
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        notes = overhead(two, client)
        print(report("Batches", [*scaling(one, two), *binding(two)], ["pliant", "dask", "distributed"], notes))
    shutil.rmtree(FOLDER)


if __name__ == "__main__":
    main()
