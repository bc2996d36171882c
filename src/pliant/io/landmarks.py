"""Landmarks: named points, in files of several kinds.

CSV (name, x, y, z), Scalismo's JSON, and 3D Slicer's markups, .mrk.json and the older .fcsv. Slicer says which way x
and y point, LPS or RAS; others do not.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pliant.errors import UnsupportedFormat
from pliant.io.files import read_bytes, write_bytes
from pliant.io.landmark_formats.named_points import Landmarks as Landmarks
from pliant.io.landmark_formats.named_points import Written
from pliant.io.report import LossReport, refuse_losses

Reader = Callable[[Path, bytes], Landmarks]
Writer = Callable[[Landmarks], Written]


def read_landmarks(path: Path | str) -> Landmarks:
    """Landmarks of a file, as they stand there.

    Parameters
    ----------
    path
        Ends in ``.csv``, ``.json`` (Scalismo), ``.mrk.json`` or ``.fcsv`` (3D Slicer).

    Raises
    ------
    UnsupportedFormat
        An ending that is not .csv, .json, .mrk.json or .fcsv.
    UnreadableFile
        Damaged contents, with the place.
    """
    reader = _handler(path)[0]
    return reader(Path(path), read_bytes(path))


def write_landmarks(landmarks: Landmarks, path: Path | str, *, strict: bool = False) -> LossReport:
    """Write landmarks; the path's ending says how.

    Parameters
    ----------
    landmarks
        What to write. Slicer's files need their ``space``; where it is None, RAS is written, and noted.
    path
        Ends in .csv, .json, .mrk.json or .fcsv.
    strict
        Refuse to write a file that would lose something.

    Raises
    ------
    LossRefused
        With ``strict``: what would be lost.
    """
    _, writer, name = _handler(path)
    data, losses, notes = writer(landmarks)
    refuse_losses(losses, Path(path), strict=strict)
    write_bytes(path, data)
    return LossReport(Path(path), name, losses, notes)


def _handler(path: Path | str) -> tuple[Reader, Writer, str]:
    """Reader, writer and name of the format that a path's ending names."""
    from pliant.io.landmark_formats import landmarks_json, landmarks_text

    name = Path(path).name.lower()
    handlers: dict[str, tuple[Reader, Writer, str]] = {
        ".mrk.json": (landmarks_json.read_markups, landmarks_json.markups, "Slicer markups"),
        ".json": (landmarks_json.read_json, landmarks_json.scalismo, "Scalismo landmarks"),
        ".fcsv": (landmarks_text.read_fcsv, landmarks_text.fcsv, "Slicer fiducials"),
        ".csv": (landmarks_text.read_csv, landmarks_text.csv, "CSV"),
    }
    for ending, handler in handlers.items():
        if name.endswith(ending):
            return handler
    raise UnsupportedFormat(f"{path}: landmarks are kept in {', '.join(handlers)}; name the file accordingly")
