"""What an attacker sends to a studio: requests of HTTP as bytes, and frames that ask for what no page should."""

from __future__ import annotations

import inspect
import json
import random
import re
from typing import Any

import numpy as np

import pliant.studio.commands  # noqa: F401 -- registers what pages can ask for
from pliant.studio.request import COMMANDS
from pliant.studio.serving.frames import Frame
from reliability.mutate import damaged
from reliability.packings import _VALUES, _changed

_ASKED = re.compile(r'request\.(text|number|integer|truth|names|several|points|indices|array|numbers)\(\s*"(\w+)"')
_UP = ("..", "%2e%2e", "..%2f", "%2e%2e%2f", "..\\", "%5c..", ".%00.", "....//", "%c0%ae%c0%ae", "\u2025")

_SOUND: tuple[tuple[str, dict[str, Any]], ...] = (  # so that there is something to damage
    ("open.example", {"name": "torus"}),
    ("lattice.add", {"basis": "bspline", "shape": [4, 4, 4]}),
    ("lattice.add", {"basis": "bezier", "shape": [3, 3, 3]}),
    ("layers.add", {"kind": "twist"}),
)


def asked() -> dict[str, dict[str, str]]:
    """What each command asks for, by name: read off its source, so that new commands are attacked too."""
    return {
        name: {field: kind for kind, field in _ASKED.findall(inspect.getsource(function))}
        for name, function in COMMANDS.items()
    }


def frame(rng: random.Random, number: int, secret: str, commands: dict[str, dict[str, str]]) -> bytes:
    """A frame: of a known command with values that are nearly right, or wrong, or damaged as a whole."""
    if rng.random() < 0.08:
        name, values = rng.choice(_SOUND)
        return Frame({"id": number, "do": name, "with": values}).encode()
    name, values = rng.choice(list(commands)), {}
    arrays: dict[str, Any] = {}
    for field, kind in commands[name].items():
        if kind in ("points", "indices", "array", "numbers"):
            arrays[field] = _array(rng, kind)
        elif rng.random() < 0.95:
            known = field == "layer" and rng.random() < 0.6
            values[field] = "Lattice" if known else _value(rng, kind, secret)
    head = {"id": number, "do": name, "with": values}
    if rng.random() < 0.1:
        head = _changed(head, rng)
        if not isinstance(head, dict):
            return json.dumps(head).encode()
    data = Frame(head, arrays).encode()
    return damaged(data, rng, ()) if rng.random() < 0.05 else data


def _value(rng: random.Random, kind: str, secret: str) -> Any:
    if rng.random() < 0.15:
        return rng.choice(_VALUES)
    if kind == "text":
        known = ("Lattice", "Lattice 2", "ring", "z", "x", "deform", "reference", "normal", "bspline", "Twist", "twist",
                 "displacement", "gaussian", "torus", "ball", ".obj", ".pliant", "radial", "tfm")  # fmt: skip
        return rng.choice(known) if rng.random() < 0.7 else _path(rng, secret)
    if kind == "integer":
        return rng.choice([0, 1, 2, 3, 8, -1, 2**31, 2**63 - 1])
    if kind == "number":
        return rng.choice([0, 1, 0.5, -1.0, 1e300, -1e300, 1e-300])
    if kind == "truth":
        return rng.random() < 0.5
    if kind == "names":
        return rng.choice([{}, {"angle": 1e300}, {"shape": [9**9] * 3}, {"axis": "q"}, {"a" * 999: None}])
    return rng.choice([[], [0, 0, 0], [1, 2, 3], [4, 4, 4], [10**9] * 3, [[0, 0, 0]], ["x"] * 5, [1e300, -1e300, 0.0],
                       [{"name": _path(rng, secret), "size": rng.choice([4, -1, 2**62])}]])  # fmt: skip


def _path(rng: random.Random, secret: str) -> str:
    up = "/".join([rng.choice(_UP)] * rng.randint(1, 9))
    return rng.choice([
        secret, f"{up}{secret}", f"{up}/secret/key.off", "link.off", "folder/../link.off", "outside/key.off",
        "../secret/key.off", "../secret/key.pliant", "/etc/passwd", "", ".", "/", "~", "a\0b", "x" * 5000,
        "file:///etc/passwd", "__class__", "ring.off/../../secret/key.off",
    ])  # fmt: skip


def _array(rng: random.Random, kind: str) -> Any:
    count = rng.choice([0, 1, 3, 6, 48, 192, 3000, 100_000])
    if kind == "indices":
        return np.array([rng.choice([0, 1, 5, 63, 2**31 - 1, 2**32 - 1]) for _ in range(min(count, 200))], np.uint32)
    if kind == "array":
        return np.frombuffer(rng.randbytes(count), np.uint8)
    return np.full(count, rng.choice([0.0, 1.0, -3.0, 1e38, 1e300]), rng.choice(["<f4", "<f8"]) if count < 9 else "<f8")


def request(rng: random.Random, port: int, cookie: str, secret: str) -> bytes:
    """A request of HTTP, as bytes, with a cookie that may be right."""
    up = "/".join([rng.choice(_UP)] * rng.randint(1, 9))
    path = rng.choice([
        f"/assets/{up}/{secret}", f"/assets/{up}/secret/key.off", f"/{up}{secret}", "/assets/" + "a" * 9000,
        "/?token=" + "%ff" * 40, "/?token=" + "x" * 60_000, "//etc/passwd", f"http://evil.example/{secret}", "/socket",
        "/alive", "/", "*", "/assets/%00", f"/assets/..;/{secret}", "/assets//" + secret, "/\r\nx: y",
    ])  # fmt: skip
    own = f"127.0.0.1:{port}"
    head = {
        "Host": rng.choice([own, own, own, own, "evil.example", "", f"{own}@evil.example", "127.0.0.1:1"]),
        "Cookie": rng.choice([cookie, cookie, cookie, "", "pliant=\xff", cookie + "x", "=" * 5000]),
        "Origin": rng.choice(["", f"http://{own}", "http://evil.example", "null", "://", "http://[::1"]),
        "Connection": "close",
    }
    if rng.random() < 0.2:
        head |= rng.choice([
            {"Content-Length": "99999999999999999999"}, {"Content-Length": "-1"}, {"Transfer-Encoding": "chunked"},
            {"Range": "bytes=-1-99999999,0-0" + ",0-0" * 500}, {"Upgrade": "websocket", "Sec-WebSocket-Version": "99"},
            {f"X-{i}": "y" * 500 for i in range(120)}, {"If-None-Match": "W/" + '"' * 3000}, {"Expect": "100-continue"},
        ])  # fmt: skip
    lines = [f"{rng.choice(['GET', 'GET', 'GET', 'HEAD', 'POST', 'PUT', 'TRACE', 'G' * 300, ''])} {path} HTTP/1.1"]
    lines += [f"{name}: {value}" for name, value in head.items() if value]
    data = "\r\n".join([*lines, "", ""]).encode("utf-8", "surrogatepass")
    return damaged(data, rng, ()) if rng.random() < 0.2 else data
