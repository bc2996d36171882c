"""Mesh files in pieces: what comes out is what the whole gives, and no more than a piece is in memory."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter, InvalidTarget, UnreadableFile, UnsupportedFormat
from pliant.examples import vase


@pytest.fixture
def shape():
    mesh = vase(240.0, 40, 30)
    random = np.random.default_rng(0)
    colors = random.integers(0, 255, (len(mesh.points), 3)).astype(np.uint8)
    normals = random.normal(size=mesh.points.shape)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return mesh.replace(vertex_attributes={"normals": normals, "colors": colors, "heat": colors[:, 0].astype(float)})


def as_ply(mesh, path, kind, order):
    """A PLY file with coordinates of a type, in a byte order, faces and a comment after the vertices' own."""
    names = ("x", "y", "z", "nx", "ny", "nz")
    row = np.dtype([(name, f"{order}{kind}") for name in names] + [("red", "u1"), ("mark", f"{order}i4")])
    data = np.zeros(len(mesh.points), row)
    for i, name in enumerate("xyz"):
        data[name], data[f"n{name}"] = mesh.points[:, i], mesh.vertex_attributes["normals"][:, i]
    data["mark"] = np.arange(len(data))
    words = {"f4": "float", "f8": "double"}
    header = [
        "ply",
        f"format binary_{'little' if order == '<' else 'big'}_endian 1.0",
        "comment made by hand",
        "element camera 2",
        "property float focal",
        f"element vertex {len(data)}",
        *(f"property {words[kind]} {name}" for name in names),
        "property uchar red",
        "property int mark",
        f"element face {len(mesh.faces)}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    faces = b"".join(
        np.uint8(len(face)).tobytes() + np.asarray(face).astype(f"{order}i4").tobytes() for face in mesh.faces
    )
    camera = np.array([1, 2], f"{order}f4").tobytes()
    path.write_bytes("\n".join(header).encode() + camera + data.tobytes() + faces)


@pytest.mark.parametrize("kind", ["f4", "f8"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("records", [97, 10_000])
def test_pieces_of_ply_give_the_whole_file(shape, stack, kind, order, records, tmp_path):
    as_ply(shape, tmp_path / "in.ply", kind, order)
    count = pl.batch.stream_mesh(stack, tmp_path / "in.ply", tmp_path / "out.ply", records=records)
    assert count == len(shape.points)
    pl.write(stack(pl.read(tmp_path / "in.ply")), tmp_path / "whole.ply")
    streamed, whole = pl.read(tmp_path / "out.ply"), pl.read(tmp_path / "whole.ply")
    tolerance = 1e-4 if kind == "f4" else 1e-10
    assert np.abs(streamed.points - whole.points).max() < tolerance
    assert np.abs(streamed.vertex_attributes["normals"] - whole.vertex_attributes["normals"]).max() < 1e-5
    data = {name: (tmp_path / f"{name}.ply").read_bytes() for name in ("in", "out", "whole")}
    assert len(data["out"]) == len(data["in"])
    place, size = data["in"].index(b"end_header\n") + 11 + 8, 6 * int(kind[1]) + 5
    stop = place + size * count
    assert data["out"][:place] == data["in"][:place]
    assert data["out"][stop:] == data["in"][stop:]
    rows = [np.frombuffer(data[name][place:stop], np.uint8).reshape(count, size)[:, -5:] for name in ("in", "out")]
    assert np.array_equal(*rows)


@pytest.mark.parametrize("records", [64, 10_000])
def test_pieces_of_stl_give_the_whole_file(shape, stack, records, tmp_path):
    pl.write(shape, tmp_path / "in.stl")
    count = pl.batch.stream_mesh(stack, tmp_path / "in.stl", tmp_path / "out.stl", records=records)
    pl.write(stack(pl.read(tmp_path / "in.stl")), tmp_path / "whole.stl")
    streamed, whole = pl.read(tmp_path / "out.stl"), pl.read(tmp_path / "whole.stl")
    assert count == len(whole.points)
    assert np.abs(streamed.points - whole.points).max() < 1e-4
    assert (tmp_path / "out.stl").read_bytes()[:84] == (tmp_path / "whole.stl").read_bytes()[:84]


def test_a_file_may_be_replaced_by_its_deformation(shape, stack, tmp_path):
    as_ply(shape, tmp_path / "a.ply", "f8", "<")
    before = pl.read(tmp_path / "a.ply")
    pl.batch.stream_mesh(stack, tmp_path / "a.ply", tmp_path / "a.ply", records=500)
    assert np.abs(pl.read(tmp_path / "a.ply").points - stack(before).points).max() < 1e-10


def test_no_more_than_a_piece_is_in_memory(tmp_path):
    count = 1_500_000
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n"
    head += "property float z\nproperty double a\nproperty double b\nproperty double c\nend_header\n"
    with (tmp_path / "large.ply").open("wb") as stream:
        stream.write(head.encode())
        rows = np.zeros(count // 15, np.dtype([("at", "<f4", 3), ("more", "<f8", 3)]))
        rows["at"] = np.random.default_rng(1).random((len(rows), 3))
        for _ in range(15):
            stream.write(rows.tobytes())
    twist = pl.Twist(axis="z", angle=1.0, bounds=(0, 1))
    pl.batch.stream_mesh(twist, tmp_path / "large.ply", tmp_path / "out.ply", records=500_000)  # compile, import
    tracemalloc.start()
    try:
        pl.batch.stream_mesh(twist, tmp_path / "large.ply", tmp_path / "out.ply", records=20_000)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    size = (tmp_path / "large.ply").stat().st_size
    assert size > 50e6
    assert peak < 16e6


def test_the_box_of_a_file(shape, tmp_path):
    as_ply(shape, tmp_path / "in.ply", "f8", ">")
    box = pl.batch.box_of(tmp_path / "in.ply", records=100)
    assert np.array_equal(box.bounds, shape.bounds)
    twists = [pl.Twist.around(each, axis="z", angle=1.0) for each in (box, shape)]
    assert twists[0].bounds == twists[1].bounds
    assert np.array_equal(twists[0].origin, twists[1].origin)


def test_what_cannot_be_read_in_pieces(shape, stack, tmp_path):
    text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    (tmp_path / "text.ply").write_text(text + "1 2 3\n")
    pl.write(shape, tmp_path / "shape.obj")
    (tmp_path / "empty.ply").write_bytes(b"")
    as_ply(shape, tmp_path / "good.ply", "f4", "<")
    (tmp_path / "cut.ply").write_bytes((tmp_path / "good.ply").read_bytes()[:3000])
    broken = shape.points.copy()
    as_ply(shape, tmp_path / "nan.ply", "f8", "<")
    data = bytearray((tmp_path / "nan.ply").read_bytes())
    at = data.index(b"end_header\n") + 11 + 8 + 53 * (len(broken) - 2)
    data[at : at + 8] = np.float64(np.nan).tobytes()
    (tmp_path / "nan.ply").write_bytes(bytes(data))
    for name, kind, cause in (
        ("text.ply", UnsupportedFormat, "is text"),
        ("shape.obj", UnsupportedFormat, "only binary PLY and STL"),
        ("empty.ply", UnreadableFile, "empty"),
        ("none.ply", UnreadableFile, "No such file"),
        ("cut.ply", UnreadableFile, "announced"),
        ("nan.ply", UnreadableFile, "in the piece of .* that begins at 2,400: .*nan"),
    ):
        output = tmp_path / f"out{name[-4:]}"
        with pytest.raises(kind, match=cause):
            pl.batch.stream_mesh(stack, tmp_path / name, output, records=100)
        assert not output.exists()
    with pytest.raises(UnsupportedFormat, match=r"write to \.ply"):
        pl.batch.stream_mesh(stack, tmp_path / "good.ply", tmp_path / "out.obj")
    with pytest.raises(InvalidTarget, match="piece by piece"):
        pl.batch.stream_mesh(pl.LaplacianEdit(np.arange(9), np.array([4])), tmp_path / "good.ply", tmp_path / "o.ply")
    with pytest.raises(InvalidParameter, match="records"):
        pl.batch.stream_mesh(stack, tmp_path / "good.ply", tmp_path / "out.ply", records=0)
