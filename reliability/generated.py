"""Meshes with all that meshes can carry, drawn at random."""

from __future__ import annotations

import numpy as np

from pliant.mesh import CornerValues, FaceLabels, Material, PolygonMesh

Random = np.random.Generator


def mesh(seed: int) -> PolygonMesh:
    """Polygons of three to seven corners, vertices that none uses, seams, names, attributes: some of it, by chance."""
    random = np.random.default_rng(seed)
    count = int(random.integers(8, 60))
    points = random.normal(size=(count, 3))
    if random.random() < 0.3:
        points = np.round(points, 2)
    points = points * 10.0 ** random.integers(-3, 4)
    most = 3 if random.random() < 0.3 else 7
    sides = random.integers(3, most + 1, int(random.integers(1, 40)))
    faces = [random.choice(count, side, replace=False).tolist() for side in sides]
    corners, maybe = int(sides.sum()), lambda share=0.5: random.random() < share
    labels = {name: _labels(random, name, len(faces)) for name in ("groups", "objects", "materials") if maybe(0.4)}
    library = {name: Material(name, tuple(random.random(3).round(3))) for name in _names(labels.get("materials"))}
    vertex, face = {}, {}
    if maybe(0.4):
        vertex["heat"] = random.normal(size=count).astype(random.choice(["f4", "f8"]))
    if maybe(0.3):
        vertex["normals"] = _units(random, count)
    if maybe(0.3):
        vertex["colors"] = random.integers(0, 256, (count, 3)).astype(np.uint8)
    if maybe(0.3):
        face["quality"] = random.normal(size=len(faces))
    if maybe(0.2):
        face["number"] = random.integers(0, 100, len(faces)).astype(np.int32)
    return PolygonMesh(
        points,
        faces,
        uvs=_corner(random, random.random((20, 2)), corners, maybe(0.3)) if maybe() else None,
        normals=_corner(random, _units(random, 15), corners, False) if maybe(0.3) else None,
        lines=[random.choice(count, int(random.integers(2, 5)), replace=False).tolist()] if maybe(0.2) else None,
        vertex_attributes=vertex,
        face_attributes=face,
        material_library=library,
        **labels,
    )


def _corner(random: Random, pool: np.ndarray, corners: int, gaps: bool) -> CornerValues:
    return CornerValues(pool, random.integers(-1 if gaps else 0, len(pool), corners))


def _units(random: Random, count: int) -> np.ndarray:
    found = random.normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1)[:, None]


def _labels(random: Random, kind: str, faces: int) -> FaceLabels:
    names = tuple(f"{kind} {i}" if kind != "materials" else f"material{i}" for i in range(int(random.integers(1, 4))))
    lowest = -1 if random.random() < 0.3 else 0
    return FaceLabels(names, random.integers(lowest, len(names), faces))


def _names(labels: FaceLabels | None) -> tuple[str, ...]:
    return () if labels is None else labels.names
