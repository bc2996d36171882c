"""The motion in a glTF: morph targets, nodes that are moved, turned and scaled, and skins that follow their joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.errors import UnreadableFile
from pliant.io.mesh_formats.gltf_file import GltfFile, item
from pliant.io.mesh_formats.gltf_scene import Matrix, all_nodes
from pliant.scene.animation.gltf_tracks import Floats, Track, Which, tracks_of

_MOST = 200_000_000  # coordinates of all frames


def animated_points(file: GltfFile, fps: float, which: Which) -> tuple[Floats, Floats]:
    """(k,) times, and (k, n, 3) the vertices then, in the order of the scene.

    There is a frame at each key; where points do not move along straight lines in between, also ``fps`` a second.

    Raises
    ------
    UnreadableFile
        Nothing moves.
    InvalidParameter
        There is no such animation.
    """
    tracks = tracks_of(file, which)
    if not tracks:
        raise UnreadableFile(file.source.name, "the animation moves no node", "export it with its motion")
    times = np.unique(np.concatenate([track.times for track in tracks.values()]))
    if "skins" in file.json or not all(track.straight for track in tracks.values()):
        between = np.arange(times[0], times[-1], 1 / fps) if (times[-1] - times[0]) * fps < _MOST else times
        times = np.unique(np.concatenate([times, between]))
    first = _frame(file, tracks, float(times[0]))
    if len(times) * first.size > _MOST:
        raise UnreadableFile(file.source.name, f"{len(times):,} frames of {len(first):,} vertices are too many")
    return times, np.stack([first, *(_frame(file, tracks, float(time)) for time in times[1:])])


def _frame(file: GltfFile, tracks: dict[tuple[int, str], Track], time: float) -> Floats:
    """(n, 3) the vertices at a time."""
    posed = GltfFile(file.source, _posed(file.json, tracks, time), file.buffers, file.binary)
    nodes, parts = posed.json.get("nodes", []), []
    places = dict(all_nodes(posed))
    for node, matrix in places.items():
        said = nodes[node]
        if "mesh" not in said:
            continue
        joints = _joints(posed, said["skin"], places) if "skin" in said else None
        mesh, known = item(posed.json["meshes"], said["mesh"]), set()
        for primitive in mesh["primitives"]:
            key = tuple(sorted(primitive["attributes"].items()))
            if key not in known:
                known.add(key)
                points = _morphed(file, primitive, said.get("weights", mesh.get("weights", ())))
                if joints is not None:
                    parts.append(_skinned(file, primitive["attributes"], points, joints))
                else:
                    parts.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    if not parts:
        raise UnreadableFile(file.source.name, "the scene holds no mesh", "export it with its meshes")
    return np.concatenate(parts)


def _posed(json: dict[str, Any], tracks: dict[tuple[int, str], Track], time: float) -> dict[str, Any]:
    nodes = [dict(node) for node in json.get("nodes", [])]
    for (node, path), track in tracks.items():
        item(nodes, node)[path] = track.at(time).tolist()
        nodes[node].pop("matrix", None)
    return {**json, "nodes": nodes}


def _morphed(file: GltfFile, primitive: dict[str, Any], weights: Any) -> Floats:
    points: Floats = file.values(primitive["attributes"]["POSITION"]).astype(np.float64)
    for weight, target in zip(weights, primitive.get("targets", ()), strict=False):
        if weight and "POSITION" in target:
            points = points + weight * dense(file, target["POSITION"])
    return points


def _joints(file: GltfFile, skin: int, places: dict[int, Matrix]) -> Floats:
    """(j, 4, 4) what each joint of a skin does to vertices at rest (glTF 2.0, section 3.7.3.3)."""
    said = item(file.json["skins"], skin)
    now = np.stack([places[joint] for joint in said["joints"]])
    if "inverseBindMatrices" not in said:
        return now
    rest = file.values(said["inverseBindMatrices"]).astype(np.float64)[: len(now)].reshape(-1, 4, 4)
    return np.asarray(now @ rest.swapaxes(1, 2))  # stored column by column


def _skinned(file: GltfFile, attributes: dict[str, int], points: Floats, joints: Floats) -> Floats:
    """Vertices as their joints carry them: linear blend skinning."""
    blended = np.zeros((len(points), 4, 4))
    for kind in (name.removeprefix("JOINTS_") for name in attributes if name.startswith("JOINTS_")):
        which = file.values(attributes[f"JOINTS_{kind}"]).astype(np.int64)
        weights = file.values(attributes[f"WEIGHTS_{kind}"]).astype(np.float64)
        if len(which) != len(points) or not 0 <= which.min() <= which.max() < len(joints):
            raise IndexError(f"JOINTS_{kind} names joints that the skin has not")
        blended += np.einsum("nj,njab->nab", weights, joints[which])
    return np.asarray(np.einsum("nab,nb->na", blended[:, :3, :3], points) + blended[:, :3, 3])


def dense(file: GltfFile, accessor: int) -> Floats:
    """(n, 3) the values of an accessor, sparse or not."""
    said = item(file.json["accessors"], accessor)
    if "bufferView" in said:
        plain = {**said}
        plain.pop("sparse", None)
        whole = GltfFile(file.source, {**file.json, "accessors": [plain]}, file.buffers, file.binary)
        values = whole.values(0).astype(np.float64)
    else:
        if not 0 <= said["count"] <= _MOST:
            raise ValueError(f"accessor {accessor} counts {said['count']}")
        values = np.zeros((said["count"], 3))
    if "sparse" in said:
        sparse = said["sparse"]
        both = [
            {"bufferView": part["bufferView"], "byteOffset": part.get("byteOffset", 0), "count": sparse["count"],
             "componentType": part.get("componentType", said["componentType"]), "type": kind}
            for part, kind in ((sparse["indices"], "SCALAR"), (sparse["values"], said["type"]))
        ]  # fmt: skip
        listed = GltfFile(file.source, {**file.json, "accessors": both}, file.buffers, file.binary)
        values = values.copy()
        values[listed.values(0)[:, 0].astype(np.int64)] = listed.values(1)
    return values
