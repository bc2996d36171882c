"""Bindings to cages in files: weights that took long are computed once, and never used for anything else.

A file is NumPy's ``.npz``: the weights, dense or sparse, and a digest of all that they depend on: the cage at rest, the
mesh's points and the kind of coordinates. Where the digest differs the file is stale, and refused.
"""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from pliant.errors import InvalidTarget, UnreadableFile
from pliant.io.files import read_bytes, write_bytes
from pliant.mesh import PolygonMesh, as_points
from pliant.space.cage import Cage
from pliant.space.cage_binding import CageBinding
from pliant.space.coordinates.table import WeightTable
from pliant.space.green_binding import GreenBinding

_LAYOUT = 1
_NAMES = ("vertices", "faces")


def write_binding(cage: Cage, binding: CageBinding | GreenBinding, path: Path | str) -> None:
    """Write the weights of points that were bound to a cage.

    Parameters
    ----------
    cage
        The deformer; where its controls are does not matter.
    binding
        What ``cage.bind`` gave.
    path
        Where to; an existing file is replaced once the new one is complete.

    Raises
    ------
    InvalidTarget
        The binding is not one of this cage.
    """
    tables = binding.tables if isinstance(binding, GreenBinding) else (binding.table,)
    if not np.array_equal(binding.rest, cage.rest):
        raise InvalidTarget("the binding was made by another cage: its rest positions differ")
    arrays: dict[str, Any] = {"layout": np.array(_LAYOUT), "digest": np.array(_digest(cage, binding.points))}
    for name, table in zip(_NAMES, tables, strict=False):
        matrix = table.matrix
        if isinstance(matrix, csr_array):
            parts = {"values": matrix.data, "columns": matrix.indices, "starts": matrix.indptr}
            arrays |= {f"{name}_{part}": array for part, array in parts.items()}
            arrays[f"{name}_shape"] = np.array(matrix.shape)
        else:
            arrays[name] = matrix
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    write_bytes(path, [buffer.getbuffer()])


def read_binding(cage: Cage, target: PolygonMesh | ArrayLike, path: Path | str) -> CageBinding | GreenBinding:
    """The binding of a target to a cage from a file, without computing its weights.

    Parameters
    ----------
    cage
        The deformer: its rest, coordinates and options must be those of the file, its controls may be anywhere.
    target
        The mesh or points that were bound.
    path
        What :func:`write_binding` wrote.

    Raises
    ------
    UnreadableFile
        No such file, damaged, or stale: the cage, the target or the options are others now.
    """
    points = as_points(target)
    arrays = _arrays(Path(path))
    if arrays["layout"].tolist() != _LAYOUT:
        raise UnreadableFile(path, f"its layout is {arrays['layout']}; {_LAYOUT} is known", "bind and write anew")
    if str(arrays["digest"]) != _digest(cage, points):
        raise UnreadableFile(
            path,
            "the weights are stale: they belong to another cage, mesh or kind of coordinates",
            "bind and write anew",
        )
    try:
        tables = [_table(arrays, name) for name in _NAMES]
    except (KeyError, ValueError, TypeError, OverflowError) as error:
        raise UnreadableFile(path, f"the weights are damaged: {error}", "bind and write anew") from error
    if tables[0] is None:
        raise UnreadableFile(path, "it holds no weights", "bind and write anew")
    if any(table is not None and table.shape[0] != len(points) for table in tables):
        raise UnreadableFile(path, "the weights are damaged: not one row a point", "bind and write anew")
    return cage.bound(points, tables[0], tables[1])


def _digest(cage: Cage, points: NDArray[np.float64]) -> str:
    """What the weights depend on, in 64 characters."""
    state = hashlib.sha256()
    for array in (cage.rest, cage.mesh.faces.flat, cage.mesh.faces.offsets, points):
        state.update(f"{array.dtype.str}{array.shape}".encode())
        state.update(np.ascontiguousarray(array).data)
    options = (cage.coordinates, cage.levels, cage.outside, cage.precision, cage.threshold)
    state.update(repr(options).encode())
    return state.hexdigest()


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    data = read_bytes(path)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            arrays = {name: np.asarray(array) for name, array in stored.items()}
    except Exception as error:  # whatever the parsers of zip and .npy say of damaged bytes
        raise UnreadableFile(path, f"it is no file of weights: {error}", "bind and write anew") from error
    if not {"layout", "digest"} <= set(arrays):
        raise UnreadableFile(path, "it is no file of weights: no digest", "bind and write anew")
    return arrays


def _table(arrays: dict[str, NDArray[Any]], name: str) -> WeightTable | None:
    if name in arrays:
        return WeightTable(_finite(arrays[name]))
    if f"{name}_values" not in arrays:
        return None
    parts = tuple(arrays[f"{name}_{part}"] for part in ("values", "columns", "starts"))
    _finite(parts[0])
    matrix = csr_array(parts, shape=tuple(int(n) for n in arrays[f"{name}_shape"]))
    matrix.check_format(full_check=True)  # an index beyond the columns would read what is not there
    return WeightTable(matrix)


def _finite(values: NDArray[Any]) -> NDArray[Any]:
    if values.dtype.kind != "f" or not np.isfinite(values).all():
        raise ValueError("some are no finite numbers")
    return values
