"""Motions in glTF that are more than morph targets: skins, splines, several animations."""

from __future__ import annotations

import base64

import numpy as np
import orjson
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

import pliant as pl
from pliant.errors import UnreadableFile

HALF = float(np.sqrt(0.5))
POINTS = np.stack([np.tile([0.0, 1.0], 5), np.repeat(np.arange(5.0), 2), np.zeros(10)], axis=1)
SHARE = np.clip(POINTS[:, 1] / 2 - 0.5, 0, 1)  # how much a vertex belongs to the upper joint


class Description:
    """A glTF of one strip, with its buffer inside."""

    def __init__(self) -> None:
        self.blob = b""
        self.json = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": [], "nodes": []}
        strip = [[2 * i + a, 2 * i + b, 2 * i + c] for i in range(4) for a, b, c in ((0, 1, 3), (0, 3, 2))]
        indices = self.put(np.array(strip, np.uint16).reshape(-1), "SCALAR", 5123)
        self.attributes = {"POSITION": self.put(POINTS, "VEC3")}
        self.json["meshes"] = [{"primitives": [{"attributes": self.attributes, "indices": indices}]}]

    def put(self, values, kind, component=5126):
        data = np.asarray(values).astype({5126: "<f4", 5123: "<u2", 5121: "u1"}[component])
        said = {"bufferView": len(self.json["bufferViews"]), "componentType": component, "type": kind}
        said |= {"count": data.size // {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]}
        if kind == "VEC3":
            said |= {"min": data.min(axis=0).tolist(), "max": data.max(axis=0).tolist()}
        raw = data.tobytes() + b"\0" * (-data.nbytes % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": data.nbytes})
        self.json["accessors"].append(said)
        self.blob += raw
        return len(self.json["accessors"]) - 1

    def animate(self, name, node, path, times, values, how="LINEAR"):
        kind = "VEC4" if path == "rotation" else "VEC3"
        sampler = {"input": self.put(times, "SCALAR"), "output": self.put(values, kind), "interpolation": how}
        channel = {"sampler": 0, "target": {"node": node, "path": path}}
        self.json.setdefault("animations", []).append({"name": name, "samplers": [sampler], "channels": [channel]})

    def save(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.blob).decode()
        self.json["buffers"] = [{"byteLength": len(self.blob), "uri": uri}]
        path.write_bytes(orjson.dumps(self.json))
        return path


def skinned(tmp_path):
    """A strip on two joints, the upper of which turns by a right angle about z in a second."""
    made = Description()
    weights = np.stack([1 - SHARE, SHARE, 0 * SHARE, 0 * SHARE], axis=1)
    made.attributes["JOINTS_0"] = made.put(np.tile([0, 1, 0, 0], (10, 1)), "VEC4", 5121)
    made.attributes["WEIGHTS_0"] = made.put(weights, "VEC4")
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[1, 1, 3] = -2.0
    bind = made.put(inverse.swapaxes(1, 2), "MAT4")  # column by column
    made.json["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [9, 9, 9]},  # a skin does not ask where its mesh's node is
        {"children": [2]},
        {"translation": [0, 2, 0]},
    ]
    made.json["skins"] = [{"joints": [1, 2], "inverseBindMatrices": bind}]
    made.animate("bow", 2, "rotation", [0, 1], [[0, 0, 0, 1], [0, 0, HALF, HALF]])
    return made.save(tmp_path / "skin.gltf")


def test_a_skin_follows_its_joints(tmp_path):
    path = skinned(tmp_path)
    motion = pl.read_sequence(path, mesh=pl.read(path, freeze=True))
    for time in (0.0, 0.5, 1.0):
        turn = Rotation.from_euler("z", time * np.pi / 2).as_matrix()
        upper = (POINTS - [0, 2, 0]) @ turn.T + [0, 2, 0]
        expected = (1 - SHARE)[:, None] * POINTS + SHARE[:, None] * upper
        np.testing.assert_allclose(motion.at(time), expected, atol=1e-6)
    assert len(motion.times) >= 24  # arcs, not chords


def test_splines_and_turns_between_keys(tmp_path):
    made = Description()
    made.json["nodes"] = [{"mesh": 0}]
    times = np.array([0.0, 1.0, 3.0])
    keys = np.random.default_rng(0).normal(size=(3, 3, 3)).astype(np.float32)
    turns = Rotation.from_euler("z", [[0], [80], [200]], degrees=True)
    made.animate("path", 0, "translation", times, keys.reshape(-1, 3), "CUBICSPLINE")
    made.animate("spin", 0, "rotation", times, turns.as_quat())
    path = made.save(tmp_path / "node.gltf")
    motion, spin = pl.read_sequence(path, fps=50), pl.read_sequence(path, fps=50, animation="spin")
    left = CubicHermiteSpline(times[:2], keys[:2, 1], np.stack([keys[0, 2], keys[1, 0]]))
    right = CubicHermiteSpline(times[1:], keys[1:, 1], np.stack([keys[1, 2], keys[2, 0]]))
    for time in (0.3, 0.74, 1.5, 2.9):
        np.testing.assert_allclose(motion.at(time), POINTS + (left if time < 1 else right)(time), atol=2e-3)
        turned = Slerp(times, turns)(time).apply(POINTS)
        np.testing.assert_allclose(spin.at(time), turned, atol=2e-3)
    with pytest.raises(UnreadableFile, match=r"no animation 2; there are: 0 'path', 1 'spin'"):
        pl.read_sequence(path, animation=2)


def test_joints_that_the_skin_has_not(tmp_path):
    path = skinned(tmp_path)
    json = orjson.loads(path.read_bytes())
    json["skins"][0]["joints"] = [1]
    path.write_bytes(orjson.dumps(json))
    with pytest.raises(UnreadableFile, match="joints that the skin has not"):
        pl.read_sequence(path)
