"""The controls of several layers as one array, one after another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import accumulate
from math import prod

import numpy as np

from pliant.deformer import Controls, Deformer, MeshDeformer

Shape = tuple[int, ...]


def flat(arrays: Iterable[Controls]) -> Controls:
    """(p,) arrays one after another."""
    return np.concatenate([np.zeros(0), *(np.asarray(array, np.float64).reshape(-1) for array in arrays)])


def parts(controls: Controls, shapes: Sequence[Shape]) -> list[Controls]:
    """The arrays of some shapes that (p,) numbers hold one after another."""
    ends = accumulate(map(prod, shapes))
    return [controls[end - prod(shape) : end].reshape(shape) for shape, end in zip(shapes, ends, strict=True)]


def controls_shape(deformer: Deformer) -> Shape:
    """The shape of a deformer's controls, also where a surface deformer does not know where they rest."""
    if not isinstance(deformer, MeshDeformer):
        return deformer.rest.shape
    handle = np.asarray(getattr(deformer, "handle", ()))
    return (int(handle.sum()) if handle.dtype == bool else len(handle)), 3
