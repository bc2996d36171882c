"""Whatever a file holds, a reader gives a valid mesh or says what is wrong; PLIANT_FUZZ sets the number of tries."""

from __future__ import annotations

import importlib.util
import io
import os
import sys
import time
import tracemalloc
import warnings
import zipfile
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from pliant.errors import PliantWarning, UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes, write
from pliant.mesh import PolygonMesh


def _beside(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}", Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


SEEDS: dict[str, bytes] = _beside("seeds").SEEDS
mutants = _beside("mutate").mutants
COUNT = int(os.environ.get("PLIANT_FUZZ", "150"))


def require_valid(mesh: PolygonMesh) -> None:
    assert np.isfinite(mesh.points).all()
    for rows in (mesh.faces, mesh.lines):
        if rows is not None and rows.flat.size:
            assert 0 <= rows.flat.min() <= rows.flat.max() < len(mesh.points)
    for corner in (mesh.uvs, mesh.normals):
        if corner is not None:
            assert len(corner.indices) == len(mesh.faces.flat)
            assert corner.indices.size == 0 or -1 <= corner.indices.min() <= corner.indices.max() < len(corner.values)


def attempt(data: bytes, ending: str) -> PolygonMesh | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        try:
            return read_mesh_bytes(data, f"mutant.{ending}")
        except (UnreadableFile, UnsupportedFormat):
            return None


@pytest.mark.parametrize("name", SEEDS)
def test_a_damaged_file_is_a_valid_mesh_or_a_clear_error(name: str) -> None:
    ending = name.partition("-")[0]
    assert attempt(SEEDS[name], ending) is not None
    begin = time.process_time()
    for data in mutants(SEEDS[name], list(SEEDS.values()), COUNT, name):
        mesh = attempt(data, ending)
        if mesh is not None:
            require_valid(mesh)
    assert time.process_time() - begin < 60 + COUNT  # a reader that does not end would hang the run


def test_a_damaged_model_in_a_sound_package_is_a_valid_mesh_or_a_clear_error() -> None:
    with zipfile.ZipFile(io.BytesIO(SEEDS["3mf"])) as package:
        text = package.read("3D/3dmodel.model")
    for damaged in mutants(text, list(SEEDS.values()), COUNT, "model"):  # else the checksum tells at once
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w") as package:
            package.writestr("3D/3dmodel.model", damaged)
        mesh = attempt(out.getvalue(), "3mf")
        if mesh is not None:
            require_valid(mesh)


@pytest.mark.parametrize("ending", ["vtp", "vtk", "vtu", "msh"])
def test_a_damaged_file_that_another_library_reads_is_a_valid_mesh_or_a_clear_error(
    ending: str, tmp_path: Path
) -> None:
    pytest.importorskip("meshio" if ending == "msh" else "vtkmodules")
    path = tmp_path / f"seed.{ending}"
    write(PolygonMesh(np.eye(3), [[0, 1, 2]], vertex_attributes={"heat": np.arange(3.0)}), path)
    for data in mutants(path.read_bytes(), list(SEEDS.values()), max(1, COUNT // 15), ending):  # a process each
        mesh = attempt(data, ending)
        if mesh is not None:
            require_valid(mesh)


@pytest.mark.parametrize("data", [b"# " * 2000 + b"\nX", b"<?xml?>" + b"<!---->" * 580, b"solid" + b"\n" * 4000])
def test_recognising_a_format_takes_no_time(data: bytes) -> None:
    begin = time.process_time()
    assert attempt(data, "dat") is None
    assert time.process_time() - begin < 10  # a pattern that goes back and forth would take years


@pytest.mark.parametrize(
    "data",
    [
        SEEDS["ply-text"].replace(b"element vertex 4", b"element vertex 1000000000"),
        SEEDS["ply-little"].replace(b"element face 2", b"element face 1000000000"),
        SEEDS["off"].replace(b"5 2 0", b"1000000000 1000000000 0"),
        SEEDS["stl-binary"][:80] + b"\xff\xff\xff\xff" + SEEDS["stl-binary"][84:],
        SEEDS["ply-strips"].replace(b"\x08\x00\x00\x00\x00\x00\x00\x00\x01", b"\xff\xff\xff\x7f\x00\x00\x00\x00\x01"),
    ],
    ids=["ply-text", "ply-binary", "off", "stl", "ply-list"],
)
def test_a_header_that_claims_a_billion_costs_no_memory(data: bytes) -> None:
    with pytest.raises(UnreadableFile):
        read_mesh_bytes(data, "liar.stl")
    tracemalloc.start()
    with pytest.raises(UnreadableFile):
        read_mesh_bytes(data, "liar.stl")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20_000_000
