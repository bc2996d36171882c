"""The motion in a glTF: weights of morph targets, and nodes that are moved, turned and scaled over time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.gltf_file import GltfFile, item
from pliant.io.gltf_scene import placed_nodes

Floats = NDArray[np.float64]
Channel = tuple[Floats, Floats, str]

_MOST = 200_000_000  # coordinates of all frames


def animated_points(file: GltfFile) -> tuple[Floats, Floats]:
    """(k,) the times of all keys of the first animation, and (k, n, 3) the vertices then, in the order of the scene.

    Raises
    ------
    UnreadableFile
        Nothing moves.
    UnsupportedFormat
        A skin moves it.
    """
    channels = _channels(file)
    if not channels:
        raise UnreadableFile(
            file.source.name, "it holds no animation", "read it as a mesh, or export it with its motion"
        )
    if any("skin" in node for node in file.json.get("nodes", [])):
        raise UnsupportedFormat(
            f"{file.source.name}: a skin moves it; bake the motion into morph targets or a point cache"
        )
    times = np.unique(np.concatenate([times for times, _, _ in channels.values()]))
    frames = [_frame(file, channels, float(time)) for time in times]
    if len(times) * frames[0].size > _MOST:
        raise UnreadableFile(file.source.name, f"{len(times):,} frames of {len(frames[0]):,} vertices are too many")
    return times, np.stack(frames)


def _channels(file: GltfFile) -> dict[tuple[int, str], Channel]:
    """Keys by node and path."""
    found: dict[tuple[int, str], Channel] = {}
    for animation in file.json.get("animations", [])[:1]:
        for channel in animation["channels"]:
            target = channel["target"]
            sampler = item(animation["samplers"], channel["sampler"])
            how = sampler.get("interpolation", "LINEAR")
            times = file.values(sampler["input"])[:, 0].astype(np.float64)
            values = file.values(sampler["output"]).astype(np.float64)
            values = values.reshape(len(times), -1)
            if how == "CUBICSPLINE":
                values = values.reshape(len(times), 3, -1)[:, 1]
                how = "LINEAR"
            if "node" in target:
                found[target["node"], target["path"]] = times, values, how
    return found


def _frame(file: GltfFile, channels: dict[tuple[int, str], Channel], time: float) -> Floats:
    """(n, 3) the vertices at a time."""
    posed = GltfFile(file.source, _posed(file.json, channels, time), file.buffers, file.binary)
    parts = []
    for node, matrix in placed_nodes(posed):
        known = set()
        said = item(posed.json["nodes"], node)
        mesh = item(posed.json["meshes"], said["mesh"])
        weights = said.get("weights", mesh.get("weights", ()))
        for primitive in mesh["primitives"]:
            key = tuple(sorted(primitive["attributes"].items()))
            if key in known:
                continue
            known.add(key)
            points = file.values(primitive["attributes"]["POSITION"]).astype(np.float64)
            for weight, target in zip(weights, primitive.get("targets", ()), strict=False):
                if weight and "POSITION" in target:
                    points = points + weight * dense(file, target["POSITION"])
            parts.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    if not parts:
        raise UnreadableFile(file.source.name, "the scene holds no mesh", "export it with its meshes")
    return np.concatenate(parts)


def _posed(json: dict[str, Any], channels: dict[tuple[int, str], Channel], time: float) -> dict[str, Any]:
    nodes = [dict(node) for node in json.get("nodes", [])]
    for (node, path), (times, values, how) in channels.items():
        item(nodes, node)[path] = _value(times, values, how, time, turning=path == "rotation").tolist()
        nodes[node].pop("matrix", None)
    return {**json, "nodes": nodes}


def _value(times: Floats, values: Floats, how: str, time: float, *, turning: bool) -> Floats:
    place = float(np.interp(time, times, np.arange(len(times))))
    first = min(int(place), len(times) - 1)
    part = place - first
    if part == 0 or how == "STEP":
        return np.asarray(values[first], np.float64)
    before, after = values[first], values[first + 1]
    if turning and before @ after < 0:
        after = -after  # the shorter way round
    mixed = (1 - part) * before + part * after
    return np.asarray(mixed / np.linalg.norm(mixed) if turning else mixed, np.float64)


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
