"""Transform files that claim, or unpack to, far more than they hold: they cost no memory."""

from __future__ import annotations

import gzip
import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from pliant.errors import PliantError
from pliant.io.transforms import read_transform
from reliability.seeds import corpus

MOST_MEMORY = 250_000_000


def bombs() -> dict[str, bytes]:
    """Files that claim, or unpack to, far more than they hold."""
    seeds = {name.removeprefix("transforms/"): data for name, data in corpus().items()}
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
def test_files_that_claim_too_much_cost_no_memory(tmp_path: Path) -> None:
    for name, data in bombs().items():
        path = tmp_path / name
        path.write_bytes(data)
        for _ in range(2):  # the first time imports what it needs
            tracemalloc.start()
            with pytest.raises(PliantError):
                read_transform(path)
            _, peak = tracemalloc.get_traced_memory()
            tracemalloc.stop()
        assert peak < MOST_MEMORY, name
