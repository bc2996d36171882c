"""What callers give, as arrays of numbers, or an error that says what is none."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.errors import PliantError


def as_numbers(what: str, values: ArrayLike | Sequence[ArrayLike], error: type[PliantError]) -> NDArray[np.float64]:
    """The values as float64, of any shape, finite or not.

    Parameters
    ----------
    what
        What they are, to begin the message with: "the origin".
    values
        Anything that reads as an array.
    error
        What is raised.

    Raises
    ------
    PliantError
        Of the kind asked for: words, nothing, rows of different lengths, whole numbers without end.
    """
    try:
        return np.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError) as cause:
        shown = repr(values)
        shown = shown if len(shown) <= 60 else f"{shown[:57]}..."
        raise error(f"{what} is {shown}; numbers are needed, in rows of one length") from cause
