"""What callers give, as numbers, or an error that says what is none."""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import Any

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


def as_number(what: str, value: Any, error: type[PliantError]) -> float:
    """One finite number.

    Parameters
    ----------
    what, error
        As for :func:`as_numbers`.
    value
        The number.

    Raises
    ------
    PliantError
        Of the kind asked for: anything else.
    """
    number = as_numbers(what, value, error)
    if number.shape or not np.isfinite(number):
        raise error(f"{what} is {value!r}; one finite number is needed")
    return float(number)


def as_count(what: str, value: Any, error: type[PliantError], least: int = 0) -> int:
    """A whole number, not below another.

    Parameters
    ----------
    what, error
        As for :func:`as_numbers`.
    value
        The number.
    least
        The least that it may be.

    Raises
    ------
    PliantError
        Of the kind asked for: a fraction, a word, a number that is too low.
    """
    try:
        number = index(value)
    except TypeError as cause:
        raise error(f"{what} is {value!r}; a whole number is needed") from cause
    if number < least:
        raise error(f"{what} is {number}; it must be {least} or more")
    return number
