"""Layer: a deformer in a stack, and how much of it there is where."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidControls, InvalidParameter, InvalidTarget
from pliant.mesh import Points
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import frozen
from pliant.scene.keys import key_of, structure_key

Floats = NDArray[np.float64]
Strength = float | Floats


@dataclass(frozen=True, eq=False)
class Layer:
    """A deformer with a name, a mask and an envelope: x' = x + s (D(x) - x), with s = envelope times mask.

    Parameters
    ----------
    name
        What it is called in its stack; not empty.
    deformer
        The deformation D.
    mask
        (n,) weights, one a vertex; None = 1 everywhere.
    invert
        Whether 1 - mask is meant. Without a mask there is nothing to invert.
    envelope
        How much of it there is: 0 nothing, 1 all. Beyond, it is exaggerated; below 0, opposed.
    muted
        Whether it is left out.
    solo
        Whether those that are not solo are left out.

    Raises
    ------
    InvalidParameter
        An empty name, a deformer that is none, weights or an envelope that are not finite.
    """

    name: str
    deformer: Deformer
    mask: ArrayLike | None = None
    invert: bool = False
    envelope: float = 1.0
    muted: bool = False
    solo: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise InvalidParameter(f"a layer's name is {self.name!r}: give it one that people can read")
        if not isinstance(self.deformer, Deformer) or type(self.deformer).__name__ == "Stack":
            raise InvalidParameter(
                f"layer {self.name!r} holds a {type(self.deformer).__name__}: it needs a deformer (to join two stacks, "
                "insert the layers of one into the other)"
            )
        try:
            envelope = float(self.envelope)
        except (TypeError, ValueError) as error:
            raise InvalidParameter(f"the envelope of layer {self.name!r} is {self.envelope!r}, no number") from error
        if not np.isfinite(envelope):
            raise InvalidParameter(f"the envelope of layer {self.name!r} is {envelope}; it must be finite")
        object.__setattr__(self, "envelope", envelope)
        if self.mask is not None:
            object.__setattr__(self, "mask", _checked_mask(self.mask, self.name))

    def changed(self, **changes: Any) -> Layer:
        """The same layer with some fields exchanged.

        Raises
        ------
        InvalidParameter
            A field that layers have not.
        """
        known = self.__dataclass_fields__
        for name in changes:
            if name not in known:
                raise InvalidParameter(f"a layer has no {name!r}; it has: {', '.join(known)}")
        new = replace(self, **changes)
        if new.deformer is self.deformer:
            new.__dict__.update({name: value for name, value in self.__dict__.items() if name == "structure"})
        return new

    def moved(self, controls: ArrayLike) -> Layer:
        """The same layer with its deformer's controls elsewhere: its structure stays.

        Parameters
        ----------
        controls
            Shaped as the deformer's.

        Raises
        ------
        InvalidControls
            Another shape, or numbers that are not finite.
        """
        new = replace(self, deformer=self.deformer.moved(controls))
        new.__dict__["structure"] = self.structure
        return new

    @property
    def in_space(self) -> bool:
        """Whether its deformer is a map of space."""
        return isinstance(self.deformer, SpaceDeformer)

    @cached_property
    def structure(self) -> bytes:
        """The key of what bindings of its deformer depend on."""
        return structure_key(self.deformer)

    @cached_property
    def content(self) -> bytes:
        """The key of all that its result depends on."""
        try:
            controls = self.deformer.controls
        except InvalidControls:  # at rest, wherever that is
            controls = None
        return key_of(self.structure, controls, self.mask, self.invert and self.mask is not None, self.envelope)

    @cached_property
    def strength(self) -> Strength:
        """S: one number, or (n,)."""
        if self.mask is None:
            return self.envelope
        mask = np.asarray(self.mask)
        return self.envelope * (1.0 - mask if self.invert else mask)

    def fits(self, count: int) -> None:
        """Make sure that the mask has a weight for each of ``count`` points.

        Parameters
        ----------
        count
            How many points the target has.

        Raises
        ------
        InvalidTarget
            It has not.
        """
        if self.mask is not None and len(np.asarray(self.mask)) != count:
            raise InvalidTarget(
                f"the mask of layer {self.name!r} has {len(np.asarray(self.mask)):,} weights; the target has {count:,} "
                "points: make the mask anew, or remove it"
            )


def column(strength: Strength) -> Strength:
    """A strength shaped to multiply (n, 3): one number, or (n, 1)."""
    return strength[:, None] if isinstance(strength, np.ndarray) else strength


def blended(before: Points, after: Points, strength: Strength) -> Points:
    """Overwrite ``after`` by before + strength (after - before)."""
    if isinstance(strength, float) and strength == 1.0:
        return after
    varying = isinstance(strength, np.ndarray)

    def work(start: int, stop: int) -> None:
        piece, base = after[start:stop], before[start:stop]
        piece -= base
        piece *= strength[start:stop, None] if varying else strength  # type: ignore[index]
        piece += base

    for_chunks(work, len(after), 8192 if len(after) > 65_536 else 65_536)
    return after


def _checked_mask(mask: ArrayLike, name: str) -> Floats:
    array = as_numbers(f"the mask of layer {name!r}", mask, InvalidParameter)
    if array.ndim != 1 or not np.isfinite(array).all():
        raise InvalidParameter(f"the mask of layer {name!r} has shape {array.shape}; (n,) finite weights are needed")
    return frozen(array, np.float64)
