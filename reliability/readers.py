"""Reading a file of a kind, and looking at what came of it: sound, refused with a clear error, or broken."""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np

import pliant as pl
from pliant.errors import PliantError, PliantWarning
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.meshes import read_mesh_bytes
from pliant.io.transforms import transform_format
from pliant.space.cage import Cage
from reliability import forks
from reliability.seeds import BOX, CORPUS, SHAPE

POINTS = np.random.default_rng(0).uniform(-10, 10, (20, 3))
IN_A_PROCESS = (  # a process each, which takes a second
    ".vtp", ".vtk", ".vtu", ".vti", ".msh", ".pvd", ".usda", ".usdc", ".abc",
)  # fmt: skip
FORKED = (".step", ".iges")  # one that is forked, which takes a tenth
REFUSED = "refused"
ACCEPTED = "accepted"


class Unsound(AssertionError):
    """A reader gave something that no caller could trust."""


def mesh(path: Path, data: bytes) -> None:
    """Read a mesh from its bytes."""
    require_valid(read_mesh_bytes(data, path.name))


def require_valid(found: pl.PolygonMesh) -> None:
    """Every position finite, every index in its range."""
    count = len(found.points)
    _require(np.isfinite(found.points).all(), "a position is not finite")
    for name, rows in (("face", found.faces), ("line", found.lines)):
        if rows is not None and rows.flat.size:
            _require(0 <= rows.flat.min() <= rows.flat.max() < count, f"a {name} has no such vertex")
    for kind, cells in found.cells.items():
        _require(not cells.size or 0 <= cells.min() <= cells.max() < count, f"a {kind} has no such vertex")
    for corner in (found.uvs, found.normals):
        if corner is not None:
            _require(len(corner.indices) == len(found.faces.flat), "corners and their values differ in number")
            inside = corner.indices.size == 0 or -1 <= corner.indices.min() <= corner.indices.max() < len(corner.values)
            _require(inside, "a corner has no such value")
    for labels in (found.groups, found.materials, found.objects):
        if labels is not None and labels.indices.size:
            inside = -1 <= labels.indices.min() <= labels.indices.max() < len(labels.names)
            _require(inside and len(labels.indices) == len(found.faces), "a face has no such label")


def transform(path: Path, data: bytes) -> None:
    """Read a transform by its content, or where that says nothing as what the file was; move points by it."""
    known = transform_format(path, data) or transform_format(path.name)
    assert known is not None
    moved = known.load().read(path, data, ReadOptions())(POINTS)
    _require(np.isfinite(moved).all(), "a point moves to no place")


def model(path: Path, _: bytes) -> None:
    """Read a shape model; its mean and an instance."""
    found = pl.read_model(path)
    instance = found.instance(np.full(found.count, 0.5))
    _require(np.isfinite(found.mean).all() and np.isfinite(instance).all(), "a shape is not finite")


def project(path: Path, _: bytes) -> None:
    """Open a project, and deform its mesh by its stack."""
    scene = pl.load_project(path)
    require_valid(scene.mesh)
    require_valid(scene.deformed())


def landmarks(path: Path, _: bytes) -> None:
    """Read landmarks."""
    found = pl.read_landmarks(path)
    _require(np.isfinite(found.points).all() and len(found.names) == len(found.points), "a landmark is not finite")


def recipe(path: Path, _: bytes) -> None:
    """Read a recipe, lay it around a shape, and deform that at rest and in motion."""
    found = pl.read_recipe(path)
    require_valid(found.stack(SHAPE)(SHAPE))
    if found.moves:
        require_valid(found.clip(SHAPE).sample(0.7))


def sequence(path: Path, _: bytes) -> None:
    """Read a motion."""
    found = pl.read_sequence(path)
    _require(np.isfinite(found.points).all() and np.isfinite(found.times).all(), "a position is not finite")


def image(path: Path, _: bytes) -> None:
    """Read an image; its grey values are whatever they are, its place must be finite."""
    found = pl.read_image(path)
    _require(all(np.isfinite(each).all() for each in (found.origin, found.spacing, found.axes)), "it has no place")


def pairs(path: Path, _: bytes) -> None:
    """Read pairs of vertices."""
    _require((pl.read_pairs(path) >= 0).all(), "an index is negative")


def weights(path: Path, _: bytes) -> None:
    """Read a binding to a cage."""
    _require(np.isfinite(pl.read_binding(Cage(BOX), SHAPE, path).deform()).all(), "a point moves to no place")


def part(path: Path, _: bytes) -> None:
    """Read a part; its volume is finite."""
    with patch("pliant.cad.files.run", forks.run):
        found = pl.cad.read(path)
    _require(np.isfinite(found.volume), "its volume is not finite")


KINDS: dict[str, Callable[[Path, bytes], None]] = {
    "meshes": mesh,
    "transforms": transform,
    "models": model,
    "projects": project,
    "landmarks": landmarks,
    "recipes": recipe,
    "sequences": sequence,
    "images": image,
    "pairs": pairs,
    "weights": weights,
    "parts": part,
}


@cache
def _place(folder: Path, kind: str) -> Path:
    """A folder with the files that a kind's files refer to."""
    place = folder / kind
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for companion in (CORPUS / kind).iterdir():
        if companion.is_dir():
            shutil.copytree(companion, place / companion.name)
    return place


def attempt(name: str, data: bytes, folder: Path) -> str:
    """Read bytes as the corpus's file of a name: ACCEPTED or REFUSED; whatever else is raised is a finding."""
    kind, _, file = name.partition("/")
    path = _place(folder, kind) / file
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PliantWarning)
        warnings.simplefilter("ignore", RuntimeWarning)  # numbers that overflow are looked for in the result
        try:
            KINDS[kind](path, data)
        except PliantError:
            return REFUSED
    return ACCEPTED


def _require(holds: object, complaint: str) -> None:
    if not holds:
        raise Unsound(complaint)
