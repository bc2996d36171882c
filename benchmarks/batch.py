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


def files(name: str, count: int, different: int, around: int, along: int) -> list[Path]:
    """So many files, of so many different vases."""
    (FOLDER / "out").mkdir(parents=True, exist_ok=True)
    paths = []
    for i in range(count):
        path = FOLDER / name / f"{i:04d}.ply"
        path.parent.mkdir(parents=True, exist_ok=True)
        pl.write(vase(200.0 + i % different, around, along), path)
        paths.append(path)
    return paths


def batch(deformation, paths: list[Path], **options) -> Callable[[], None]:
    def work() -> None:
        found = list(pl.run_batch(deformation, paths, FOLDER / "out" / "{stem}-{index}.ply", **options))
        assert all(each.status == "ok" for each in found), found[0].error

    return work


def loop(deformers, paths: list[Path]) -> Callable[[], None]:
    def work() -> None:
        for i, (deformer, path) in enumerate(zip(deformers, paths, strict=True)):
            pl.write(deformer(pl.read(path)), FOLDER / "out" / f"{path.stem}-{i}.ply")

    return work


def scaling(one: ProcessPoolExecutor, two: ProcessPoolExecutor) -> Comparison:
    paths = files("large", 24, 24, 200, 100)
    shape = pl.read(paths[0])
    ffd = pl.BSplineFFD.around(shape, shape=(8, 8, 8))
    stack = pl.Stack([pl.Layer("ffd", ffd.moved(ffd.rest + 3.0)), pl.Layer("cage", posed(shape, 1)[0])])
    return Comparison(
        "24 files of 20k points, a lattice and a cage",
        {"two processes": batch(stack, paths, executor=two), "one process": batch(stack, paths, executor=one)},
        rounds=5,
    )


def posed(shape: pl.PolygonMesh, count: int) -> list[pl.Cage]:
    """A cage around a shape, and as many poses of it."""
    cage = pl.Cage(cage_from_box(shape, (4, 4, 4)))
    size = 0.03 * shape.diagonal
    poses = np.random.default_rng(0).normal(size=(count, *cage.rest.shape)) * size
    return [cage.moved(cage.rest + pose) for pose in poses]


def binding(two: ProcessPoolExecutor) -> list[str]:
    """A thousand small files against a loop that binds each anew."""
    notes = []
    for different, words in ((1, "of one shape, each posed its own way"), (1000, "of as many shapes, one pose")):
        paths = files(f"small{different}", 1000, different, 40, 30)
        cages = posed(pl.read(paths[0]), 1000) if different == 1 else posed(pl.read(paths[0]), 1) * 1000
        tasks = [cage.controls for cage in cages]
        ways = {
            "this process": lambda n, p=paths, c=cages, t=tasks: batch(c[0], p[:n], controls=t[:n], workers=0),
            "two processes": lambda n, p=paths, c=cages, t=tasks: batch(c[0], p[:n], controls=t[:n], executor=two),
            "the loop": lambda n, p=paths, c=cages: loop(c[:n], p[:n]),
        }
        seconds = {}
        for name, way in ways.items():
            way(20)()
            seconds[name] = clock(way(1000))
        told = ", ".join(f"{name} {value:.2f} s ({seconds['the loop'] / value:.1f})" for name, value in seconds.items())
        notes.append(
            f"1,000 files of 1.2k points {words}, a cage of mean value coordinates; ratio to the loop: {told}."
        )
    return notes


def overhead(two: ProcessPoolExecutor, client: Client) -> list[str]:
    """Milliseconds a job beside reading, deforming and writing."""
    paths = files("tiny", 300, 300, 8, 6)
    twist = pl.Twist.around(pl.read(paths[0]), axis="z", angle=1.0)
    ways = {
        "this process": batch(twist, paths, workers=0),
        "a pool": batch(twist, paths, executor=two),
        "a Dask cluster": batch(twist, paths, executor=client),
    }
    plain, found = loop([twist] * 300, paths), {}
    for name, work in ways.items():
        pairs = [(clock(work), clock(plain)) for _ in range(4)][1:]
        found[name] = statistics.median(ours - theirs for ours, theirs in pairs) / 300 * 1e3
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
        notes = [*overhead(two, client), "", *binding(two)]
        print(report("Batches", [scaling(one, two)], ["pliant", "dask", "distributed"], notes))
    shutil.rmtree(FOLDER)


if __name__ == "__main__":
    main()
