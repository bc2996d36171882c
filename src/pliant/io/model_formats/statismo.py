"""Statistical shape models as statismo and Scalismo keep them: what the datasets of their files mean.

The mean is absolute; the basis is U, next to eigenvalues λ (version 0.9), or U √λ (0.8, and files that do not say);
U need not be orthonormal. Model and representer may lie under a prefix, as ``/shape`` in face models.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import PliantError, UnreadableFile
from pliant.io.model_formats.model_tree import Tree
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.shape.basis import factored
from pliant.shape.model import ShapeModel
from pliant.shape.tetrahedra import boundary

_KINDS = {1: "POINT_SET", 2: "LINE_MESH", 3: "POLYGON_MESH", 4: "VOLUME_MESH"}
_CONVENTION = "/modelinfo/modelBuilder-0/parameters/eigenvalues"


def model_of(tree: Tree, path: Path, prefix: str | None = None) -> ShapeModel:
    """The model of a file.

    Raises
    ------
    UnreadableFile
        Parts are missing, contradict each other or are not finite; or there are several models and no prefix.
    """
    found = _prefix(tree, path, prefix)
    mean = tree.numbers(path, f"{found}/model/mean").astype(np.float64).reshape(-1)
    variance = tree.numbers(path, f"{found}/model/pcaVariance").astype(np.float64).reshape(-1)
    basis = tree.numbers(path, f"{found}/model/pcaBasis").astype(np.float64)
    points = tree.numbers(path, f"{found}/representer/points").astype(np.float64)
    if points.ndim != 2 or points.shape[0] != 3:
        raise UnreadableFile(path, f"{found}/representer/points has shape {points.shape}; (3, N) is expected")
    count = points.shape[1]
    for name, shape, expected in (
        ("mean", mean.shape, (3 * count,)),
        ("pcaBasis", basis.shape, (3 * count, len(variance))),
    ):
        if shape != expected:
            raise UnreadableFile(path, f"{found}/model/{name} has shape {shape}; {expected} fits the representer")
    if (variance < 0).any():
        raise UnreadableFile(path, f"{found}/model/pcaVariance holds a negative variance: {variance.min():g}")
    deviations = np.sqrt(variance)
    fields = basis * deviations if _version(tree) >= (0, 9) else basis
    cells = _cells(tree, path, found, count)
    try:
        return ShapeModel(
            _mesh(points.T, cells),
            mean.reshape(-1, 3),
            factored(np.ascontiguousarray(fields).reshape(count, 3, len(deviations)), deviations),
            cells=cells if cells is not None and cells.shape[1] == 4 else None,
            convention="continuous" if str(tree.values.get(_CONVENTION)) == "continuous" else "discrete",
            noise_variance=_noise(tree, found),
            carrier=tree,
        )
    except UnreadableFile:
        raise
    except PliantError as error:
        raise UnreadableFile(path, str(error), "the file is damaged") from error


def tree_of(model: ShapeModel, prefix: str = "") -> Tree:
    """The datasets of a model, version 0.9; those that it was read from, where it was read and not changed."""
    if isinstance(model.carrier, Tree):
        return model.carrier
    deviations = model.basis.deviations
    spread = np.repeat(deviations, 3) if model.basis.scalar else deviations
    columns = model.basis.columns().reshape(-1, len(spread))
    directions = np.divide(columns, spread, out=np.zeros_like(columns), where=spread > 0)
    cells = model.cells
    if cells is None and len(model.reference.triangles):
        cells = model.reference.triangles
    if cells is None and model.reference.lines is not None:
        cells = np.array(list(_segments(model.reference.lines)), np.int32).reshape(-1, 2)
    tree = Tree()
    tree.values = {
        f"{prefix}/model/mean": model.mean.astype(np.float32).reshape(-1),
        f"{prefix}/model/noiseVariance": np.array([model.noise_variance], np.float32),
        f"{prefix}/model/pcaBasis": directions.astype(np.float32),
        f"{prefix}/model/pcaVariance": (spread**2).astype(np.float32),
        f"{prefix}/representer/points": np.ascontiguousarray(model.reference.points.T.astype(np.float32)),
        "/version/majorVersion": np.array(0, np.int32),
        "/version/minorVersion": np.array(9, np.int32),
        "/modelinfo/modelBuilder-0/builderName": "pliant",
        _CONVENTION: model.convention,
    }
    if cells is not None:
        tree.values[f"{prefix}/representer/cells"] = np.ascontiguousarray(cells.T.astype(np.int32))
    tree.attributes[f"{prefix}/representer"] = {
        "name": "itkStandardMeshRepresenter",
        "datasetType": _KINDS[1 if cells is None else cells.shape[1]],
        "version/majorVersion": "0",
        "version/minorVersion": "9",
    }
    return tree


def losses_of(model: ShapeModel) -> tuple[str, ...]:
    """What the format cannot hold of a model."""
    if isinstance(model.carrier, Tree):
        return ()
    mesh, losses = model.reference, []
    polygons = int((mesh.faces.lengths > 3).sum())
    if polygons and model.cells is None:
        losses.append(f"{polygons:,} polygons are cut into triangles")
    if model.process is not None:
        losses.append("the kernel: the fields are kept at the vertices only")
    if mesh.uvs is not None or mesh.vertex_attributes or mesh.face_attributes:
        losses.append("texture coordinates and attributes of the reference")
    return tuple(losses)


def _prefix(tree: Tree, path: Path, wanted: str | None) -> str:
    ending = "/model/mean"
    found = [place[: -len(ending)] for place in tree.values if place.endswith(ending)]
    if wanted is not None:
        clean = "/" + wanted.strip("/") if wanted.strip("/") else ""
        if clean not in found:
            raise UnreadableFile(path, f"there is no model under {clean or '/'}; there is one under {found or 'none'}")
        return clean
    if not found:
        raise UnreadableFile(path, "there is no /model/mean in it", "it is no statismo model")
    if "" in found:
        return ""
    if len(found) > 1:
        raise UnreadableFile(path, f"there are several models in it: {', '.join(found)}", "choose one by prefix=")
    return found[0]


def _version(tree: Tree) -> tuple[int, int]:
    try:
        stored = (np.asarray(tree.values[f"/version/{name}Version"]) for name in ("major", "minor"))
        major, minor = (int(value.reshape(-1)[0]) for value in stored)
    except (KeyError, ValueError, IndexError):
        return 0, 8  # as old files are
    return major, minor


def _noise(tree: Tree, prefix: str) -> float:
    value: Any = tree.values.get(f"{prefix}/model/noiseVariance")
    return 0.0 if value is None or isinstance(value, str) or not value.size else float(value.reshape(-1)[0])


def _cells(tree: Tree, path: Path, prefix: str, count: int) -> NDArray[np.int32] | None:
    place = f"{prefix}/representer/cells"
    if place not in tree.values or not np.size(tree.values[place]):
        return None
    stored = tree.numbers(path, place)
    if stored.ndim != 2 or stored.shape[0] not in (2, 3, 4) or stored.dtype.kind not in "iu":
        raise UnreadableFile(path, f"{place} has shape {stored.shape}; (2, M), (3, M) or (4, M) is expected")
    bad = np.flatnonzero((stored.astype(np.int64) >= count) | (stored.astype(np.int64) < 0))
    if len(bad):
        cell, vertex = bad[0] % stored.shape[1], stored.reshape(-1)[bad[0]]
        raise UnreadableFile(path, f"cell {cell} uses vertex {vertex}; there are {count}", "the file is damaged")
    return np.ascontiguousarray(stored.T).astype(np.int32)


def _mesh(points: NDArray[np.float64], cells: NDArray[np.int32] | None) -> PolygonMesh:
    if cells is None:
        return PolygonMesh(points)
    if cells.shape[1] == 2:
        return PolygonMesh(points, lines=Ragged.of(cells))
    return PolygonMesh(points, Ragged.of(cells if cells.shape[1] == 3 else boundary(points, cells)))


def _segments(lines: Ragged) -> Iterator[tuple[int, int]]:
    for line in lines:
        yield from zip(line[:-1].tolist(), line[1:].tolist(), strict=True)
