"""The nodes of a glTF scene: where each mesh stands."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.gltf_file import GltfFile, item

Matrix = NDArray[np.float64]


def placed_nodes(file: GltfFile) -> Iterator[tuple[int, Matrix]]:
    """Each node of the scene that has a mesh, as :func:`all_nodes`."""
    nodes = file.json.get("nodes", [])
    return ((index, matrix) for index, matrix in all_nodes(file) if "mesh" in nodes[index])


def all_nodes(file: GltfFile) -> Iterator[tuple[int, Matrix]]:
    """Each node of the scene, and the (4, 4) matrix from its own space to the world's, depth first.

    Raises
    ------
    UnreadableFile
        A node with two parents, or one that is its own.
    """
    json = file.json
    nodes = json.get("nodes", [])
    if json.get("scenes"):
        roots = item(json["scenes"], json.get("scene", 0)).get("nodes", [])
    else:
        children = {child for node in nodes for child in node.get("children", [])}
        roots = [i for i in range(len(nodes)) if i not in children]
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        index, above = waiting.pop()
        node = item(nodes, index)
        if index in seen:
            raise file.source.unreadable(f"node {index} has two parents", "export the file again")
        seen.add(index)
        matrix = above @ _local(node)
        if not np.isfinite(matrix).all():
            raise file.source.unreadable(f"node {index} has a matrix that is not finite", "export the file again")
        yield index, matrix
        waiting += [(child, matrix) for child in reversed(node.get("children", []))]


def _local(node: dict[str, Any]) -> Matrix:
    """The matrix of a node: given, or a translation after a rotation after a scaling."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    result = np.eye(4)
    rotation = _rotation(np.array(node.get("rotation", [0, 0, 0, 1]), np.float64))
    result[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]), np.float64)
    result[:3, 3] = node.get("translation", [0, 0, 0])
    return result


def _rotation(quaternion: NDArray[np.float64]) -> Matrix:
    """The rotation of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion / (np.linalg.norm(quaternion) or 1.0)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors of length one; zero stays zero."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    result = np.zeros_like(vectors)
    np.divide(vectors, length, out=result, where=length > 0)
    return result
