"""What a model file holds, whether it is HDF5 or the JSON that newer Scalismo writes: datasets, groups, attributes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import UnreadableFile

Value = NDArray[Any] | str


@dataclass
class Tree:
    """The contents of a file by path, as in ``/model/mean``; strings are strings, whether the file wraps them or not.

    Parameters
    ----------
    values
        Arrays and strings.
    attributes
        Of groups, by path and name; all are strings.
    groups
        Paths of groups, the empty ones too.
    """

    values: dict[str, Value] = field(default_factory=dict)
    attributes: dict[str, dict[str, str]] = field(default_factory=dict)
    groups: set[str] = field(default_factory=set)

    def numbers(self, path: Path | str, place: str) -> NDArray[Any]:
        """An array of finite numbers.

        Raises
        ------
        UnreadableFile
            It is not there, is no array of numbers, or holds some that are not finite.
        """
        value = self.values.get(place)
        if value is None:
            raise UnreadableFile(path, f"there is no {place} in it", "it is no statismo model, or damaged")
        if isinstance(value, str) or value.dtype.kind not in "fiu":
            raise UnreadableFile(path, f"{place} is no array of numbers", "the file is damaged")
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            raise UnreadableFile(path, f"{place} holds numbers that are not finite", "the file is damaged")
        return value


def simple(value: Any) -> Value | None:
    """A value as it is kept: text as a string, wrapped or not; None for what no model holds."""
    array = np.asarray(value)
    if array.dtype.kind in "SUO":
        if array.size != 1:
            return None
        word = array.reshape(-1)[0]
        return word.decode("utf-8", "replace") if isinstance(word, bytes) else str(word)
    return array if array.dtype.kind in "fiu" else None
