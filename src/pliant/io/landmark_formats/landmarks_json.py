"""Landmarks in JSON: Scalismo's list, and 3D Slicer's markups."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import orjson
from numpy.typing import NDArray

from pliant.errors import UnreadableFile
from pliant.io.landmark_formats.named_points import Landmarks, Space, Written, lost, numbers, told

Floats = NDArray[np.float64]

_SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#"
)
_SPACES: dict[Any, Space] = {"LPS": "LPS", "RAS": "RAS", "0": "RAS", "1": "LPS", 0: "RAS", 1: "LPS"}
_PRETTY = orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE


def read_json(path: Path, data: bytes) -> Landmarks:
    """Scalismo's landmarks, or Slicer's where the file holds those.

    Raises
    ------
    UnreadableFile
        No JSON, no list, or an entry without coordinates.
    """
    content = _parsed(path, data)
    if isinstance(content, dict) and "markups" in content:
        return read_markups(path, data)
    if not isinstance(content, list):
        raise UnreadableFile(path, "the file is no list of landmarks", "Scalismo's files begin with [")
    names, points, words, covariances = [], [], [], []
    for at, entry in enumerate(content):
        if not isinstance(entry, dict) or "coordinates" not in entry:
            raise UnreadableFile(path, f"entry {at} has no coordinates", "each landmark needs an id and coordinates")
        names.append(str(entry.get("id", at)))
        points.append(numbers(path, entry["coordinates"], f"landmark {names[-1]!r}"))
        words.append(str(entry.get("description") or ""))
        covariances.append(_covariance(path, entry.get("uncertainty"), names[-1]))
    return Landmarks(names, np.array(points).reshape(-1, 3), None, words, np.array(covariances).reshape(-1, 3, 3))


def scalismo(landmarks: Landmarks) -> Written:
    """Scalismo's list: ids, coordinates, descriptions and uncertainties."""
    entries = []
    for name, point, words, covariance in zip(
        landmarks.names,
        landmarks.points.tolist(),
        landmarks.descriptions,
        np.asarray(landmarks.covariances),
        strict=True,
    ):
        entry: dict[str, Any] = {"id": name, "coordinates": point}
        if words:
            entry["description"] = words
        if np.isfinite(covariance).all():
            variances, axes = np.linalg.eigh(covariance)
            deviations = np.sqrt(np.maximum(variances, 0))
            entry["uncertainty"] = {"stddevs": deviations[::-1].tolist(), "pcvectors": axes.T[::-1].tolist()}
        entries.append(entry)
    spaceless = () if landmarks.space is None else (f"that they are {landmarks.space}",)
    return orjson.dumps(entries, option=_PRETTY), spaceless, ()


def read_markups(path: Path, data: bytes) -> Landmarks:
    """All control points of all markups of a Slicer file whose position is defined.

    Raises
    ------
    UnreadableFile
        No JSON, no markups, or other coordinate systems than LPS or RAS.
    """
    content = _parsed(path, data)
    markups = content.get("markups") if isinstance(content, dict) else None
    if not isinstance(markups, list) or not all(isinstance(markup, dict) for markup in markups):
        raise UnreadableFile(path, "the file holds no markups", "save it again from Slicer as .mrk.json")
    spaces = {str(markup.get("coordinateSystem", "LPS")) for markup in markups} or {"LPS"}
    if len(spaces) > 1 or not spaces <= set(map(str, _SPACES)):
        raise UnreadableFile(path, f"coordinate systems {sorted(spaces)}", "one of LPS and RAS is understood")
    names, points, words = [], [], []
    for markup in markups:
        entries = markup.get("controlPoints") or []
        if not isinstance(entries, list):
            raise UnreadableFile(path, f"the control points are {entries!r}", "save it again from Slicer as .mrk.json")
        for at, entry in enumerate(entries):
            if not isinstance(entry, dict):
                raise UnreadableFile(path, f"control point {at} is {entry!r}", "each needs a label and a position")
            if entry.get("positionStatus", "defined") != "defined":
                continue
            names.append(str(entry.get("label") or entry.get("id") or at + 1))
            points.append(numbers(path, entry.get("position"), f"control point {names[-1]!r}"))
            words.append(str(entry.get("description") or ""))
    return Landmarks(names, np.array(points).reshape(-1, 3), _SPACES[spaces.pop()], words)


def markups(landmarks: Landmarks) -> Written:
    """A point list of Slicer."""
    space, notes = told(landmarks)
    points = [
        {"id": str(at + 1), "label": name, "description": words, "position": point, "positionStatus": "defined"}
        for at, (name, words, point) in enumerate(
            zip(landmarks.names, landmarks.descriptions, landmarks.points.tolist(), strict=True)
        )
    ]
    content = {
        "@schema": _SCHEMA,
        "markups": [{"type": "Fiducial", "coordinateSystem": space, "coordinateUnits": "mm", "controlPoints": points}],
    }
    return orjson.dumps(content, option=_PRETTY), lost(landmarks, covariances=True), notes


def _parsed(path: Path, data: bytes) -> Any:
    try:
        return orjson.loads(data.removeprefix(b"\xef\xbb\xbf"))
    except orjson.JSONDecodeError as error:
        cause = f"it is no JSON: {error.msg}"
        raise UnreadableFile(
            path, cause, "was it cut off, or is it another kind of file?", line=error.lineno
        ) from error


def _covariance(path: Path, given: Any, name: str) -> Floats:
    """From standard deviations along unit vectors."""
    if given is None:
        return np.full((3, 3), np.nan)
    if not isinstance(given, dict) or not isinstance(given.get("pcvectors"), list) or len(given["pcvectors"]) != 3:
        raise UnreadableFile(path, f"the uncertainty of landmark {name!r} is not understood", "see Scalismo's format")
    deviations = numbers(path, given.get("stddevs"), f"uncertainty of landmark {name!r}")
    axes = np.array([numbers(path, row, f"uncertainty of landmark {name!r}") for row in given["pcvectors"]])
    return cast(Floats, np.einsum("k,ki,kj->ij", deviations**2, axes, axes))
