"""Log densities made of others: products, and what was evaluated is remembered."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter

Floats = NDArray[np.float64]
LogDensity = Callable[[Floats], float]
Result = TypeVar("Result")

_LAST = 8  # states whose results are remembered: a step asks for two, a mixture several times


@dataclass(frozen=True, eq=False)
class ProductDensity:
    """The product of densities, as of a prior, of landmarks and of a surface: their logarithms are added.

    What is zero by one factor is not asked of those after it: cheap ones come first.

    Parameters
    ----------
    factors
        Functions from a state (k,) to a logarithm.
    """

    factors: tuple[LogDensity, ...]

    def __init__(self, *factors: LogDensity) -> None:
        if not factors:
            raise InvalidParameter("a product of densities has at least one factor")
        object.__setattr__(self, "factors", factors)

    def __call__(self, state: Floats) -> float:
        total = 0.0
        for each in self.factors:
            total += each(state)
            if total == -np.inf:
                break
        return total


@dataclass(frozen=True, eq=False)
class CachedDensity:
    """A density that remembers the last states it was asked for.

    Parameters
    ----------
    density
        The density.
    """

    density: LogDensity
    _asked: LogDensity = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_asked", remembering(self.density))

    def __call__(self, state: Floats) -> float:
        return self._asked(state)


def remembering(function: Callable[[Floats], Result]) -> Callable[[Floats], Result]:
    """The function of a state, with its last results at hand."""
    known: OrderedDict[bytes, Result] = OrderedDict()

    def asked(state: Floats) -> Result:
        key = np.ascontiguousarray(state, np.float64).tobytes()
        if key not in known:
            known[key] = function(state)
            if len(known) > _LAST:
                known.popitem(last=False)
        return known[key]

    return asked
