"""Morph targets and their animation, added to a glTF that holds a mesh at rest.

Spec: Khronos glTF 2.0, sections 3.7.2.2 (morph targets), 3.6.2.3 (sparse accessors) and 3.11 (animations).
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.io.mesh_formats.gltf_builder import normals_of
from pliant.io.mesh_formats.gltf_file import GltfFile, packed
from pliant.io.mesh_formats.gltf_scene import unit
from pliant.io.mesh_formats.losses import as_float32
from pliant.mesh import PolygonMesh

Floats = NDArray[np.float64]

_FLOAT, _SHORT, _INT = 5126, 5123, 5125


@dataclass(frozen=True, eq=False)
class Share:
    """The part of a mesh that a primitive draws.

    Parameters
    ----------
    mesh, primitive
        Which one of the file.
    node
        The node that shows it.
    vertices, corners
        (m,) the mesh's vertex that each of its own is, and a corner where it is used, or -1.
    linear
        (3, 3) from its own space to the world's.
    """

    mesh: int
    primitive: int
    node: int
    vertices: NDArray[np.int64]
    corners: NDArray[np.int64]
    linear: Floats


class MorphWriter:
    """A glTF with targets and weights being added.

    Parameters
    ----------
    file
        The mesh at rest.
    shares
        Where its vertices are in the file.
    mesh
        The mesh at rest itself.
    """

    def __init__(self, file: GltfFile, shares: Sequence[Share], mesh: PolygonMesh) -> None:
        self._json: dict[str, Any] = file.json
        self._binary, self._shares, self._mesh = file.binary, shares, mesh
        self._chunk = bytearray(file.buffers[0])
        self._names: list[str] = []

    def add_target(self, name: str, frame: PolygonMesh) -> None:
        """One more target of every primitive: how positions and normals of the mesh differ in a frame."""
        self._names.append(name)
        known: dict[tuple[int, bytes], int] = {}
        moved = frame.points - self._mesh.points
        for share in self._shares:
            primitive = self._json["meshes"][share.mesh]["primitives"][share.primitive]
            own = np.asarray(np.linalg.solve(share.linear, moved[share.vertices].T).T, np.float64)
            target = {"POSITION": self._known(known, own)}
            if "NORMAL" in primitive["attributes"]:
                target["NORMAL"] = self._known(known, _normals(frame, share) - _normals(self._mesh, share))
            primitive.setdefault("targets", []).append(target)

    def _known(self, known: dict[tuple[int, bytes], int], values: Floats) -> int:
        """The accessor of (m, 3) values, one for those that are alike."""
        local = np.ascontiguousarray(as_float32(values, "glTF")[0]) + np.float32(0.0)  # no negative zeros
        key = len(local), local.tobytes()
        if key not in known:
            known[key] = self._accessor(local)
        return known[key]

    def finish(self, times: Sequence[float] | None = None, weights: Floats | None = None) -> list[bytes]:
        """The parts of the file.

        Parameters
        ----------
        times, weights
            (k,) seconds and (k, t) the weight of every target then; None = nothing moves by itself.
        """
        for place in {share.mesh for share in self._shares}:
            mesh = self._json["meshes"][place]
            mesh["weights"] = [0.0] * len(self._names) if weights is None else [float(w) for w in weights[0]]
            mesh["extras"] = {**mesh.get("extras", {}), "targetNames": self._names}
        if times is not None and weights is not None:
            self._animate(times, weights)
        buffer = self._json["buffers"][0]
        buffer["byteLength"] = len(self._chunk)
        if not self._binary:
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self._chunk).decode()
        return packed(self._json, self._chunk, binary=self._binary)

    def _animate(self, times: Sequence[float], weights: Floats) -> None:
        seconds = np.asarray(times, np.float32)
        bounds = {"min": [float(seconds[0])], "max": [float(seconds[-1])]}
        inputs = self._described(self._view(seconds), _FLOAT, len(seconds), "SCALAR", bounds)
        values = np.ascontiguousarray(weights, np.float32)
        outputs = self._described(self._view(values), _FLOAT, values.size, "SCALAR", {})
        nodes = sorted({share.node for share in self._shares})
        self._json["animations"] = [
            {
                "name": "clip",
                "samplers": [{"input": inputs, "output": outputs, "interpolation": "LINEAR"}],
                "channels": [{"sampler": 0, "target": {"node": node, "path": "weights"}} for node in nodes],
            }
        ]

    def _accessor(self, values: NDArray[np.float32]) -> int:
        """Displacements: only those that are not zero, where that is shorter."""
        low, high = values.min(axis=0, initial=0.0), values.max(axis=0, initial=0.0)
        bounds: dict[str, Any] = {"min": low.tolist(), "max": high.tolist()}
        moved = np.flatnonzero(values.any(axis=1))
        width = 2 if len(values) <= 65_536 else 4
        if len(moved) * (12 + width) >= 12 * len(values):
            bounds = {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
            return self._described(self._view(values, 34962), _FLOAT, len(values), "VEC3", bounds)
        if not len(moved):
            return self._described(None, _FLOAT, len(values), "VEC3", bounds)
        indices = moved.astype(np.uint16 if width == 2 else np.uint32)
        said = {
            "count": len(moved),
            "indices": {"bufferView": self._view(indices), "componentType": _SHORT if width == 2 else _INT},
            "values": {"bufferView": self._view(np.ascontiguousarray(values[moved]))},
        }
        return self._described(None, _FLOAT, len(values), "VEC3", {**bounds, "sparse": said})

    def _described(self, view: int | None, kind: int, count: int, shape: str, more: dict[str, Any]) -> int:
        place = {} if view is None else {"bufferView": view}
        self._json["accessors"].append({**place, "componentType": kind, "count": count, "type": shape, **more})
        return len(self._json["accessors"]) - 1

    def _view(self, values: NDArray[Any], target: int | None = None) -> int:
        self._chunk += b"\0" * (-len(self._chunk) % 4)
        said: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._chunk), "byteLength": values.nbytes}
        self._chunk += values.tobytes()
        self._json["bufferViews"].append(said if target is None else {**said, "target": target})
        return len(self._json["bufferViews"]) - 1


def _normals(mesh: PolygonMesh, share: Share) -> Floats:
    """(m, 3) unit normals of a share's vertices in its own space."""
    found = normals_of(mesh, share.vertices, share.corners)
    return np.zeros((len(share.vertices), 3)) if found is None else unit(found @ share.linear)
