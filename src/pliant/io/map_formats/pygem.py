"""PyGeM's ``.prm`` parameters: a box, turned about its origin, and Bernstein weights in box lengths; push-forward.

The box is turned by R = Rz Ry Rx; a weight (a, b, c) of a control point moves it by R (a lx, b ly, c lz), with the
lengths l of the box. Points outside the box stay.
"""

from __future__ import annotations

import configparser
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import UnreadableFile, UnsupportedFormat
from pliant.io.files import write_bytes
from pliant.io.map_formats.itk_matrices import euler
from pliant.io.map_formats.transform_options import ReadOptions
from pliant.io.map_formats.words import numbers
from pliant.io.report import LossReport, refuse_losses
from pliant.io.text import number_text
from pliant.space.bezier_ffd import BezierFFD

Floats = NDArray[np.float64]

NAME = "PyGeM parameters"
_BOX, _WEIGHTS = "Box info", "Parameters weights"
_MOST = 1_000_000  # control points: more than Bernstein polynomials can bear


def read(path: Path, data: bytes, options: ReadOptions) -> SpaceDeformer:
    """The lattice of a file.

    Raises
    ------
    UnreadableFile
        A section or value that is missing or is no number, or a weight beyond the lattice.
    """
    options.require_physical(path)
    parser = configparser.RawConfigParser(strict=False)
    try:
        parser.read_string(data.decode("utf-8-sig", "replace"))
    except configparser.Error as error:
        raise UnreadableFile(path, " ".join(str(error).split()), "correct the file") from error
    shape = _three(path, parser, "n control points")
    if not ((shape >= 1) & (shape == np.round(shape)) & (shape < 1000)).all() or shape.prod() > _MOST:
        raise UnreadableFile(path, f"a lattice of {shape.tolist()} control points", "1 to 999 an axis are expected")
    nx, ny, nz = (int(n) for n in shape)
    lengths, origin = _three(path, parser, "box length"), _three(path, parser, "box origin")
    if not (lengths > 0).all():
        raise UnreadableFile(path, f"the box has lengths {lengths.tolist()}", "they must be positive")
    turn = euler(np.radians(_three(path, parser, "rotation angle", np.zeros(3))), zyx=True)
    weights = np.stack([_weights(path, parser, axis, (nx, ny, nz)) for axis in "xyz"], axis=-1)
    edges = turn * lengths
    return BezierFFD(displacements=weights @ edges.T, origin=origin, edges=edges)


def _three(path: Path, parser: configparser.RawConfigParser, name: str, default: Floats | None = None) -> Floats:
    """Three numbers of the box."""
    if default is not None and not parser.has_option(_BOX, f"{name} x"):
        return default
    texts = [_text(path, parser, _BOX, f"{name} {axis}") for axis in "xyz"]
    return np.concatenate([numbers(path, text, 1, what=name, count=1) for text in texts])


def _text(path: Path, parser: configparser.RawConfigParser, section: str, option: str) -> bytes:
    if not parser.has_option(section, option):
        raise UnreadableFile(path, f"there is no {option!r} in [{section}]", "the file is cut off or damaged")
    return parser.get(section, option).encode()


def _weights(path: Path, parser: configparser.RawConfigParser, axis: str, shape: tuple[int, int, int]) -> Floats:
    """(nx, ny, nz) weights along an axis: those that are not listed are 0."""
    rows = numbers(path, _text(path, parser, _WEIGHTS, f"parameter {axis}"), 1, what=f"parameter {axis}")
    if len(rows) % 4:
        raise UnreadableFile(path, f"parameter {axis}: {len(rows)} numbers; lines of four are expected", "i j k weight")
    table = rows.reshape(-1, 4)
    index = table[:, :3]
    wrong = np.flatnonzero(((index < 0) | (index >= shape) | (index != np.round(index))).any(axis=1))
    if len(wrong):
        size = " x ".join(map(str, shape))
        raise UnreadableFile(path, f"parameter {axis}: {index[wrong[0]].tolist()} is no control point of {size}")
    weights = np.zeros(shape)
    weights[tuple(index.astype(np.int64).T)] = table[:, 3]
    return weights


def write(deformer: Deformer, path: Path, *, strict: bool) -> LossReport:
    """Write a Bernstein lattice of one patch in a rectangular, right-handed box.

    Raises
    ------
    UnsupportedFormat
        Another deformer, a block of patches, or a box that is sheared or left-handed.
    """
    if not isinstance(deformer, BezierFFD) or (deformer.patches is not None and deformer.patches != (1, 1, 1)):
        kind = f"{type(deformer).__name__} of patches" if isinstance(deformer, BezierFFD) else type(deformer).__name__
        raise UnsupportedFormat(f"{path}: PyGeM holds one Bernstein lattice, not a {kind}: refit it (pliant convert)")
    lengths = np.linalg.norm(deformer.edges, axis=0)
    turn = deformer.edges / lengths
    if np.abs(turn.T @ turn - np.eye(3)).max() > 1e-9 or np.linalg.det(turn) < 0:
        raise UnsupportedFormat(f"{path}: PyGeM's boxes are rectangular and right-handed; this one is not: refit it")
    goes_on = deformer.outside != "identity" and bool(deformer.displacements.any())
    losses = ("what happens outside the box: there, points stay",) if goes_on else ()
    refuse_losses(losses, path, strict=strict)
    weights = deformer.displacements @ np.linalg.inv(deformer.edges).T
    write_bytes(path, _content(deformer, lengths, np.degrees(_angles(turn)), weights).encode())
    return LossReport(path, NAME, losses)


def _content(deformer: BezierFFD, lengths: Floats, angles: Floats, weights: Floats) -> str:
    text = f"\n[{_BOX}]\n"
    for name, values in (
        ("n control points", np.array(deformer.shape)),
        ("box length", lengths),
        ("box origin", deformer.origin),
        ("rotation angle", angles),
    ):
        words = number_text(values).decode().split(",")
        text += "".join(f"{name} {axis}: {word}\n" for axis, word in zip("xyz", words, strict=True)) + "\n"
    text += f"[{_WEIGHTS}]\n"
    index = np.stack(np.unravel_index(np.arange(prod(deformer.shape)), deformer.shape), axis=1).tolist()
    for axis in range(3):
        words = number_text(weights[..., axis] + 0.0).decode().split(",")
        rows = [f"   {i}   {j}   {k}   {word}\n" for (i, j, k), word in zip(index, words, strict=True)]
        text += f"\nparameter {'xyz'[axis]}:" + "             ".join(rows)
    return text


def _angles(turn: Floats) -> Floats:
    """(3,) radians about x, y and z of R = Rz Ry Rx."""
    y = np.arctan2(-turn[2, 0], np.hypot(turn[2, 1], turn[2, 2]))
    if abs(turn[2, 0]) > 1 - 1e-12:  # x and z turn about the same axis: all of it is given to z
        return np.array([0.0, y, np.arctan2(-turn[0, 1], turn[1, 1])])
    return np.array([np.arctan2(turn[2, 1], turn[2, 2]), y, np.arctan2(turn[1, 0], turn[0, 0])])
