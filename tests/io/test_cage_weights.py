"""Weights of cages in files: the same to the last bit, and never used where they do not belong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pliant.cages.boxes import cage_from_box
from pliant.errors import InvalidTarget, UnreadableFile
from pliant.examples import vase
from pliant.io.cage_weights import read_binding, write_binding
from pliant.space.cage import Cage

MESH = vase(around=16, along=8)
BOX = cage_from_box(MESH, cells=(1, 1, 2))
POSED = BOX.points + np.random.default_rng(0).normal(size=BOX.points.shape) * 5


@pytest.mark.parametrize("kind", ["mean_value", "green"])
@pytest.mark.parametrize("options", [{}, {"threshold": 0.01}, {"precision": "float32"}], ids=str)
def test_a_binding_comes_back_as_it_was(tmp_path, kind, options):
    cage = Cage(BOX, coordinates=kind, **options)
    bound = cage.bind(MESH)
    write_binding(cage, bound, tmp_path / "weights.npz")
    again = read_binding(cage.moved(POSED), MESH, tmp_path / "weights.npz")
    assert np.array_equal(again.deform(), bound.deform(POSED))
    assert np.array_equal(again.vjp(POSED, MESH.points), bound.vjp(POSED, MESH.points))


def test_stale_weights_are_refused(tmp_path):
    cage, path = Cage(BOX), tmp_path / "weights.npz"
    write_binding(cage, cage.bind(MESH), path)
    moved = MESH.with_points(MESH.points + 1e-9)
    others = [
        (Cage(BOX.with_points(BOX.points * (1 + 1e-12))), MESH),
        (cage, moved),
        (replace(cage, coordinates="green"), MESH),
        (replace(cage, outside="keep"), MESH),
        (replace(cage, precision="float32"), MESH),
    ]
    for deformer, target in others:
        with pytest.raises(UnreadableFile, match="stale"):
            read_binding(deformer, target, path)


def test_other_files_are_refused(tmp_path):
    cage, path = Cage(BOX), tmp_path / "weights.npz"
    with pytest.raises(UnreadableFile, match="No such file"):
        read_binding(cage, MESH, path)
    for content in (b"", b"no archive", b"PK\x03\x04 broken"):
        path.write_bytes(content)
        with pytest.raises(UnreadableFile):
            read_binding(cage, MESH, path)
    np.savez(path, something=np.zeros(3))
    with pytest.raises(UnreadableFile, match="no digest"):
        read_binding(cage, MESH, path)
    write_binding(cage, cage.bind(MESH), path)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UnreadableFile):
        read_binding(cage, MESH, path)


def test_a_binding_of_another_cage_is_not_written(tmp_path):
    with pytest.raises(InvalidTarget, match="another cage"):
        write_binding(Cage(BOX), Cage(cage_from_box(MESH)).bind(MESH), tmp_path / "weights.npz")
