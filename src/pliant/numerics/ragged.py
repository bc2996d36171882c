"""Rows of different lengths in one flat array: how polygons are kept."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.numerics.compute.chunks import for_chunks

Indices = NDArray[np.int32]


def frozen(array: ArrayLike, dtype: Any) -> NDArray[Any]:
    """The values as a read-only C-ordered array of a type; copied only where the caller could still write."""
    given = np.asarray(array, dtype)
    base = given
    while isinstance(base, np.ndarray) and not base.flags.writeable and base.base is not None:
        base = base.base  # a read-only view of somebody's writable array is still theirs to change
    safe = isinstance(base, np.ndarray) and not base.flags.writeable and given.flags.c_contiguous
    result = given if safe else _copied(given)
    result.flags.writeable = False
    return result


def source(array: NDArray[Any]) -> NDArray[Any]:
    """A read-only view: what kernels read then has one type, and they are compiled once."""
    view = array.view()
    view.flags.writeable = False
    return view


def _copied(array: NDArray[Any]) -> NDArray[Any]:
    """A C-ordered copy; large ones by all processors, since fresh memory is slow to touch."""
    result = np.empty(array.shape, array.dtype)
    if array.ndim:
        for_chunks(lambda start, stop: np.copyto(result[start:stop], array[start:stop]), len(array))
    else:
        result[()] = array
    return result


@dataclass(frozen=True, eq=False)
class Ragged(Sequence[Indices]):
    """A read-only sequence of index rows.

    Parameters
    ----------
    flat
        (k,) all rows one after another.
    offsets
        (r + 1,) row ``i`` is ``flat[offsets[i]:offsets[i + 1]]``.
    """

    flat: Indices
    offsets: NDArray[np.int64]

    def __post_init__(self) -> None:
        object.__setattr__(self, "flat", frozen(self.flat, np.int32))
        object.__setattr__(self, "offsets", frozen(self.offsets, np.int64))

    @classmethod
    def of(cls, rows: Ragged | ArrayLike | Iterable[ArrayLike]) -> Ragged:
        """Rows from another ragged array, an (r, k) array, or any iterable of rows."""
        if isinstance(rows, Ragged):
            return rows
        if isinstance(rows, np.ndarray) and rows.ndim == 2:
            return cls(rows.reshape(-1), np.arange(rows.shape[0] + 1) * rows.shape[1])
        arrays = [np.asarray(row, np.int32).reshape(-1) for row in rows]  # type: ignore[union-attr]
        lengths = np.array([len(row) for row in arrays], np.int64)
        flat = np.concatenate(arrays) if arrays else np.empty(0, np.int32)
        return cls(flat, np.concatenate([[0], np.cumsum(lengths)]))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return Ragged.of([self[i] for i in range(*index.indices(len(self)))])
        row = range(len(self))[index]
        return self.flat[self.offsets[row] : self.offsets[row + 1]]

    def __iter__(self) -> Iterator[Indices]:
        return (self.flat[a:b] for a, b in zip(self.offsets[:-1], self.offsets[1:], strict=True))

    @cached_property
    def lengths(self) -> NDArray[np.int64]:
        """(r,) how long each row is."""
        return np.diff(self.offsets)

    @cached_property
    def uniform(self) -> int | None:
        """The length that all rows share, or None."""
        if not len(self):
            return None
        first = int(self.lengths[0])
        return first if (self.lengths == first).all() else None

    @cached_property
    def row_of(self) -> NDArray[np.int32]:
        """(k,) the row that each entry of ``flat`` belongs to."""
        return np.repeat(np.arange(len(self), dtype=np.int32), self.lengths)
