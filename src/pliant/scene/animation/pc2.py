"""PC2 point caches: float32 positions frame by frame, as Blender and 3ds Max keep them.

Header: ``POINTCACHE2`` and a zero, version 1, the number of points, the first frame and the step between frames, both
counted in frames, and the number of frames; little-endian.
"""

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

_HEADER = struct.Struct("<12siiffi")
_MAGIC = b"POINTCACHE2\0"


def write_clip(clip: Clip, path: Path, progress: Progress | None) -> LossReport:
    """Positions of all frames."""
    with replacing(path) as temporary, temporary.open("wb") as stream:
        stream.write(_HEADER.pack(_MAGIC, 1, len(clip.mesh.points), 0.0, 1.0, len(clip.times)))
        for frame in clip.frames(progress):
            stream.write(frame_of_float32(frame.points, path, "<f4"))
    return cache_report(path, "PC2", f"frames count at {clip.fps:g} a second, which the file does not say")


def read(path: Path, fps: float) -> MeshSequence:
    """The motion of a file that counts frames.

    Raises
    ------
    UnreadableFile
        Another header, or another length than it says.
    InvalidParameter
        Positions that are not finite.
    """
    data = read_bytes(path)
    if not data.startswith(_MAGIC) or len(data) < _HEADER.size:
        raise UnreadableFile(path, "it does not begin as a PC2 point cache", "check what it is", byte=0)
    _, version, points, first, step, frames = _HEADER.unpack_from(data)
    if version != 1 or points < 1 or frames < 1 or not 0 < step < np.inf or not np.isfinite(first):
        raise UnreadableFile(path, f"its header says version {version}, {points} points, {frames} frames, step {step}")
    needed = _HEADER.size + 12 * points * frames
    if len(data) != needed:
        raise UnreadableFile(
            path, f"{frames} frames of {points:,} points are {needed:,} bytes; it has {len(data):,}", "export it again"
        )
    positions = np.frombuffer(data, "<f4", offset=_HEADER.size).reshape(frames, points, 3)
    return MeshSequence(positions.astype(np.float32), (first + step * np.arange(frames)) / fps)
