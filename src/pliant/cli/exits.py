"""What the command line returns to the shell."""

from __future__ import annotations

from enum import IntEnum

from pliant import errors


class Exit(IntEnum):
    """Exit codes; scripts may rely on them."""

    OK = 0
    BUG = 1
    USAGE = 2
    UNREADABLE = 3
    NO_RESULT = 4
    REFUSED = 5


EXPLAINED = """\
\b
Exit codes:
  0  done
  1  a bug in pliant
  2  wrong usage, or something that is not installed
  3  a file that cannot be read or written, or does not fit
  4  no result: not converged, or not finite
  5  refused by a quality gate: --strict, and something would be lost; or a gate of check
"""

_BY_KIND = (
    ((errors.NotConverged, errors.NonFiniteResult), Exit.NO_RESULT),
    ((errors.LossRefused,), Exit.REFUSED),
    ((errors.InvalidParameter, errors.InvalidControls, errors.MissingExtra, errors.NoGraphics), Exit.USAGE),
)


def exit_code(error: errors.PliantError | OSError) -> Exit:
    """The code of an error; what is not listed has to do with an input: it cannot be read, or does not fit."""
    return next((code for kinds, code in _BY_KIND if isinstance(error, kinds)), Exit.UNREADABLE)
