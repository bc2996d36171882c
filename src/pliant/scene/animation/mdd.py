"""MDD point caches, LightWave's: big-endian counts, times in seconds, float32 positions frame by frame."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from pliant.errors import UnreadableFile
from pliant.io.files import read_bytes, replacing
from pliant.io.report import LossReport
from pliant.scene.animation.caches import cache_report, frame_of_float32
from pliant.scene.clip import Clip, Progress
from pliant.scene.sequence import MeshSequence

_HEADER = struct.Struct(">ii")


def write_clip(clip: Clip, path: Path, progress: Progress | None) -> LossReport:
    """Positions of all frames, and their times."""
    with replacing(path) as temporary, temporary.open("wb") as stream:
        stream.write(_HEADER.pack(len(clip.times), len(clip.mesh.points)))
        stream.write(np.array(clip.times, ">f4").tobytes())
        for frame in clip.frames(progress):
            stream.write(frame_of_float32(frame.points, path, ">f4"))
    return cache_report(path, "MDD")


def read(path: Path, fps: float) -> MeshSequence:
    """The motion of a file; its times are its own.

    Raises
    ------
    UnreadableFile
        Another length than the header says.
    InvalidParameter
        Positions that are not finite.
    """
    data = read_bytes(path)
    frames, points = _HEADER.unpack_from(data) if len(data) >= _HEADER.size else (0, 0)
    if frames < 1 or points < 1:
        raise UnreadableFile(path, f"its header says {frames} frames of {points} points", "check what it is", byte=0)
    needed = _HEADER.size + 4 * frames + 12 * points * frames
    if len(data) != needed:
        raise UnreadableFile(
            path, f"{frames} frames of {points:,} points are {needed:,} bytes; it has {len(data):,}", "export it again"
        )
    times = np.frombuffer(data, ">f4", frames, _HEADER.size).astype(np.float64)
    if (np.diff(times) <= 0).any():  # some programs write zeros
        times = np.arange(frames) / fps
    positions = np.frombuffer(data, ">f4", offset=_HEADER.size + 4 * frames).reshape(frames, points, 3)
    return MeshSequence(positions.astype(np.float32), times)
