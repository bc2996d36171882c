"""Whatever a transform file holds, it is a map without NaN or a clear error; PLIANT_FUZZ sets the number of tries."""

from __future__ import annotations

import gzip
import importlib.util
import io
import os
import sys
import time
import tracemalloc
import warnings
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import pliant as pl
from pliant.errors import PliantError, PliantWarning
from pliant.io.transform_options import ReadOptions
from pliant.io.transforms import read_transform, transform_format
from pliant.space.compose import compose


def _beside(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}", Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


mutants = _beside("mutate").mutants
SLOW = ("a.vti",)  # read in a process of its own
COUNT = int(os.environ.get("PLIANT_FUZZ", "150"))
POINTS = np.random.default_rng(0).uniform(-10, 10, (20, 3))
MOST_MEMORY = 250_000_000

FFD = pl.BSplineFFD(
    displacements=np.random.default_rng(1).normal(size=(4, 5, 4, 3)), origin=(0, 1, 2), spacing=(2, 3, 4), edge="zero"
)
GRID = pl.DisplacementGrid(
    displacements=np.random.default_rng(2).normal(size=(3, 2, 3, 3)), origin=(0, 1, 2), spacing=(2, 3, 4), rim=0.5
)
BOX = pl.BezierFFD.around(np.eye(3), shape=(3, 2, 2))
AFFINE = pl.Affine.rotation("x", 0.3)
MADE = {
    "a.FFD": FFD,
    "a.AFF": AFFINE,
    "a.tfm": compose(AFFINE, FFD, GRID),
    "a.h5": FFD,
    "a.0.txt": FFD,
    "affine.txt": AFFINE,
    "a.nii": FFD,
    "b.nii.gz": GRID,
    "a.mha": GRID,
    "a.vti": GRID,
    "a.dof": compose(AFFINE, FFD),
    "a.dof.gz": FFD,
    "a.prm": BOX.moved(BOX.rest + 0.01 * POINTS[:12].reshape(3, 2, 2, 3)),
    "a.xyz": pl.ClampedFFD.around(np.eye(3), shape=(2, 5, 2)),
}


@pytest.fixture(scope="module")
def seeds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("seeds")
    for name, deformer in MADE.items():
        pl.write_transform(deformer, folder / name)
    return {name: (folder / name).read_bytes() for name in MADE}


def attempt(path: Path, name: str, data: bytes) -> None:
    """Read by content, or, where that says nothing, as the format that the file was."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        try:
            known = transform_format(path, data) or transform_format(name)
            assert known is not None
            deformer = known.load().read(path, data, ReadOptions())
            moved = deformer(POINTS)
        except PliantError:
            return
    assert np.isfinite(moved).all()


@pytest.mark.parametrize("name", MADE)
def test_a_damaged_file_is_a_map_or_a_clear_error(tmp_path: Path, seeds: dict[str, bytes], name: str) -> None:
    path = tmp_path / name
    begin = time.process_time()
    packed = name.endswith(".gz")
    seed = gzip.decompress(seeds[name]) if packed else seeds[name]
    for data in mutants(seed, list(seeds.values()), COUNT // 50 if name in SLOW else COUNT, name):
        attempt(path, name, gzip.compress(data, 1) if packed else data)
    for data in mutants(seeds[name], list(seeds.values()), COUNT // 4, f"{name} packed") if packed else []:
        attempt(path, name, data)
    assert time.process_time() - begin < 60 + COUNT  # a reader that does not end would hang the run


def bombs(seeds: dict[str, bytes]) -> dict[str, bytes]:
    """Files that claim, or unpack to, far more than they hold."""
    nifti = bytearray(seeds["a.nii"])
    nifti[42:48] = np.array([30000, 30000, 30000], "<i2").tobytes()
    dof = bytearray(seeds["a.dof.gz"])
    stream = io.BytesIO()
    with gzip.GzipFile(fileobj=stream, mode="wb", mtime=0) as packed:
        packed.write(gzip.decompress(bytes(dof))[:8] + bytes(12))
        for _ in range(300):
            packed.write(bytes(1 << 20))
    return {
        "a.FFD": seeds["a.FFD"].replace(b"\n4\n5\n4\n", b"\n4000\n5000\n4000\n"),
        "a.tfm": b"#Insight Transform File V1.0\nTransform: BSplineTransform_double_3_3\nParameters: 0\n"
        b"FixedParameters: 90000 90000 90000 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n",
        "a.0.txt": seeds["a.0.txt"].replace(b"GridSize", b"GridSize 90000 90000 90000)\n(Grid"),
        "a.nii": bytes(nifti),
        "b.nii.gz": gzip.compress(bytes(nifti)),
        "a.mha": seeds["a.mha"].replace(b"DimSize = 3 2 3", b"DimSize = 90000 20000 300"),
        "a.dof": seeds["a.dof"].replace((4).to_bytes(4, "big"), (2**30).to_bytes(4, "big")),
        "a.dof.gz": stream.getvalue(),
        "a.prm": seeds["a.prm"].replace(b"points x: 3", b"points x: 999").replace(b"points y: 2", b"points y: 999"),
        "a.xyz": seeds["a.xyz"].replace(b"2 5 2", b"90000 90000 90000"),
    }


@pytest.mark.filterwarnings("ignore::pliant.errors.PliantWarning")
def test_files_that_claim_too_much_cost_no_memory(tmp_path: Path, seeds: dict[str, bytes]) -> None:
    for name, data in bombs(seeds).items():
        path = tmp_path / name
        path.write_bytes(data)
        for _ in range(2):  # the first time imports what it needs
            tracemalloc.start()
            with pytest.raises(PliantError):
                read_transform(path)
            _, peak = tracemalloc.get_traced_memory()
            tracemalloc.stop()
        assert peak < MOST_MEMORY, name
