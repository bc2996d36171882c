"""Headers that claim what no file holds, and patterns that go back and forth: they cost neither memory nor time."""

from __future__ import annotations

import time
import tracemalloc

import pytest

from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.meshes import read_mesh_bytes
from reliability.handmade import MESHES


@pytest.mark.parametrize("data", [b"# " * 2000 + b"\nX", b"<?xml?>" + b"<!---->" * 580, b"solid" + b"\n" * 4000])
def test_recognising_a_format_takes_no_time(data: bytes) -> None:
    begin = time.process_time()
    with pytest.raises((UnreadableFile, UnsupportedFormat)):
        read_mesh_bytes(data, "mutant.dat")
    assert time.process_time() - begin < 10  # a pattern that goes back and forth would take years


@pytest.mark.parametrize(
    "data",
    [
        MESHES["text.ply"].replace(b"element vertex 4", b"element vertex 1000000000"),
        MESHES["little.ply"].replace(b"element face 2", b"element face 1000000000"),
        MESHES["usual.off"].replace(b"5 2 0", b"1000000000 1000000000 0"),
        MESHES["binary.stl"][:80] + b"\xff\xff\xff\xff" + MESHES["binary.stl"][84:],
        MESHES["strips.ply"].replace(b"\x08\x00\x00\x00\x00\x00\x00\x00\x01", b"\xff\xff\xff\x7f\x00\x00\x00\x00\x01"),
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
