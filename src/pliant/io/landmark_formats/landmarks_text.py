"""Landmarks as lines of text: CSV, and 3D Slicer's older fiducials."""

from __future__ import annotations

import csv as lines
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pliant.errors import UnreadableFile
from pliant.io.landmark_formats.named_points import Landmarks, Space, Written, lost, numbers, told

_COLUMNS = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID"
_NAMES = {"name", "label", "id", "landmark"}


def read_csv(path: Path, data: bytes) -> Landmarks:
    """Rows of a name and three numbers, or of three numbers; a first row without numbers names the columns.

    Raises
    ------
    UnreadableFile
        No rows, or some without three numbers.
    """
    rows = list(_rows(path, data))
    if not rows:
        raise UnreadableFile(path, "the file holds no landmarks", "each line needs a name, x, y and z")
    columns = [word.strip().lower() for word in rows[0][1]]
    if {"x", "y", "z"} <= set(columns):
        rows = rows[1:]
        where = [columns.index(axis) for axis in "xyz"]
        naming = next((i for i, word in enumerate(columns) if word in _NAMES), None)
        wording = next((i for i, word in enumerate(columns) if word.startswith("desc")), None)
    else:
        named = len(rows[0][1]) > 3
        where, naming, wording = [int(named) + i for i in range(3)], 0 if named else None, None
    names, points, words = [], [], []
    for at, (line, row) in enumerate(rows):
        if len(row) <= max(where):
            raise UnreadableFile(path, f"{len(row)} values, too few for a landmark", "add what is missing", line=line)
        names.append(row[naming].strip() if naming is not None else str(at + 1))
        points.append(numbers(path, [row[i] for i in where], "a landmark", line=line))
        words.append(row[wording].strip() if wording is not None and wording < len(row) else "")
    return Landmarks(names, np.array(points).reshape(-1, 3), None, words)


def csv(landmarks: Landmarks) -> Written:
    """Columns name, x, y, z, and description where there is one."""
    described = any(landmarks.descriptions)
    out = io.StringIO()
    writer = lines.writer(out, lineterminator="\n", quoting=lines.QUOTE_NONNUMERIC)  # a name may begin with #
    writer.writerow(["name", "x", "y", "z", *(["description"] if described else [])])
    for name, point, words in zip(landmarks.names, landmarks.points.tolist(), landmarks.descriptions, strict=True):
        writer.writerow([name, *point, *([words] if described else [])])
    spaceless = () if landmarks.space is None else (f"that they are {landmarks.space}",)
    return out.getvalue().encode(), (*spaceless, *lost(landmarks, covariances=True)), ()


def read_fcsv(path: Path, data: bytes) -> Landmarks:
    """Slicer's fiducials; its versions before 4.11 wrote RAS, or 0 for it, and named the columns as later ones do.

    Raises
    ------
    UnreadableFile
        Another coordinate system, or rows without three numbers.
    """
    space: Space = "RAS"
    columns = _COLUMNS.split(",")
    for comment in (text[1:] for text in _text(path, data).splitlines() if text.startswith("#")):
        key, _, value = comment.partition("=")
        if key.strip() == "CoordinateSystem":
            known: dict[str, Space] = {"0": "RAS", "RAS": "RAS", "1": "LPS", "LPS": "LPS"}
            if value.strip() not in known:
                raise UnreadableFile(path, f"coordinate system {value.strip()!r}", "LPS and RAS are understood")
            space = known[value.strip()]
        elif key.strip() == "columns":
            columns = [word.strip() for word in value.split(",")]
    missing = {"x", "y", "z"} - set(columns)
    if missing:
        raise UnreadableFile(path, f"there is no column {sorted(missing)[0]!r}", "save it again from Slicer")
    names, points, words = [], [], []
    for at, (line, row) in enumerate(_rows(path, data)):
        values = dict(zip(columns, (word.strip() for word in row), strict=False))
        names.append(values.get("label") or values.get("id") or str(at + 1))
        points.append(numbers(path, [values.get(axis) for axis in "xyz"], f"landmark {names[-1]!r}", line=line))
        words.append(values.get("desc", ""))
    return Landmarks(names, np.array(points).reshape(-1, 3), space, words)


def fcsv(landmarks: Landmarks) -> Written:
    """Slicer's fiducials, as its version 4.13 writes them."""
    space, notes = told(landmarks)
    out = io.StringIO()
    out.write(f"# Markups fiducial file version = 4.13\n# CoordinateSystem = {space}\n# columns = {_COLUMNS}\n")
    writer = lines.writer(out, lineterminator="\n")
    for at, (name, point, words) in enumerate(
        zip(landmarks.names, landmarks.points.tolist(), landmarks.descriptions, strict=True)
    ):
        writer.writerow([at + 1, *map(repr, point), 0, 0, 0, 1, 1, 1, 0, name, words, ""])
    return out.getvalue().encode(), lost(landmarks, covariances=True), notes


def _text(path: Path, data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise UnreadableFile(path, "it is no UTF-8 text", "save it as UTF-8", byte=error.start) from error


def _rows(path: Path, data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and values of the lines that hold something; commas, semicolons or tabs separate."""
    text = _text(path, data).splitlines()
    body = [(at, line) for at, line in enumerate(text, 1) if line.strip() and not line.lstrip().startswith("#")]
    first = body[0][1] if body else ""
    separator = next((mark for mark in ",;\t" if mark in first), ",")
    for at, line in body:
        try:
            yield at, next(lines.reader([line], delimiter=separator, strict=True))
        except lines.Error as error:
            raise UnreadableFile(path, str(error), "mind the quotation marks", line=at) from error
