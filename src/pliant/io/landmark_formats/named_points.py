"""What landmarks are, whatever their file: named points, and which way x and y point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, UnreadableFile
from pliant.numerics.given import as_numbers
from pliant.numerics.ragged import frozen

Floats = NDArray[np.float64]
Space = Literal["RAS", "LPS"]
Written = tuple[bytes, tuple[str, ...], tuple[str, ...]]
"""The bytes of a file, what they do not hold, and what their readers should know."""


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Named points.

    Parameters
    ----------
    names
        (k,) one a landmark; blanks and line ends within become single blanks.
    points
        (k, 3) positions, as in the file.
    space
        Which way x and y point: "RAS" right and anterior, "LPS" left and posterior; None where nothing says so.
    descriptions
        (k,) words, or none.
    covariances
        (k, 3, 3) how uncertain each position is; NaN where nothing is known.

    Raises
    ------
    InvalidParameter
        Another number of names than points, positions that are not finite, an unknown space.
    """

    names: Sequence[str]
    points: Floats
    space: Space | None = None
    descriptions: Sequence[str] = ()
    covariances: Floats | None = None

    def __post_init__(self) -> None:
        names, points = tuple(map(_one_line, self.names)), as_numbers("points", self.points, InvalidParameter)
        if points.size % 3:
            raise InvalidParameter(f"points have shape {points.shape}; (k, 3) is needed")
        points = points.reshape(-1, 3)
        if len(names) != len(points):
            raise InvalidParameter(f"{len(points)} landmarks have {len(names)} names: each needs one")
        bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
        if len(bad):
            raise InvalidParameter(f"landmark {names[bad[0]]!r} is not finite: {points[bad[0]].tolist()}")
        if self.space is not None and self.space not in get_args(Space):
            raise InvalidParameter(f"space is {self.space!r}; it must be 'RAS', 'LPS' or None")
        words = tuple(map(_one_line, self.descriptions)) or ("",) * len(names)
        covariances = np.full((len(names), 3, 3), np.nan) if self.covariances is None else self.covariances
        if len(words) != len(names) or np.shape(covariances) != (len(names), 3, 3):
            raise InvalidParameter("descriptions and covariances need one entry a landmark")
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "descriptions", words)
        object.__setattr__(self, "points", frozen(points, np.float64))
        object.__setattr__(self, "covariances", frozen(covariances, np.float64))

    def __len__(self) -> int:
        return len(self.names)

    def __getitem__(self, name: str) -> Floats:
        """(3,) the position of a landmark by name."""
        if name not in self.names:
            raise InvalidParameter(f"there is no landmark {name!r}; there are: {', '.join(self.names)}")
        position: Floats = self.points[list(self.names).index(name)]
        return position

    def in_space(self, space: Space) -> Self:
        """The same landmarks with x and y pointing the way that a space has them.

        Parameters
        ----------
        space
            ``"LPS"`` or ``"RAS"``.

        Raises
        ------
        InvalidParameter
            Nothing says which way they point now: set ``space`` first, by ``dataclasses.replace``.
        """
        if self.space is None:
            raise InvalidParameter("nothing says which way x and y of these landmarks point: say so first")
        signs = np.ones(3) if space == self.space else np.array([-1.0, -1.0, 1.0])
        turned = np.asarray(self.covariances) * np.outer(signs, signs)
        return replace(self, points=self.points * signs, space=space, covariances=turned)

    def common(self, other: Landmarks) -> tuple[tuple[str, ...], Floats, Floats]:
        """The names that both have, in this one's order, and the (k, 3) positions of each.

        Parameters
        ----------
        other
            Other landmarks, in the same space.
        """
        names = tuple(name for name in self.names if name in set(other.names))
        return (
            names,
            np.array([self[n] for n in names]).reshape(-1, 3),
            np.array([other[n] for n in names]).reshape(-1, 3),
        )


def numbers(path: Path, values: Any, what: str, *, line: int | None = None) -> Floats:
    """(3,) finite numbers of a file.

    Raises
    ------
    UnreadableFile
        Anything else.
    """
    try:
        array = np.array([float(value) for value in values])
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise UnreadableFile(path, f"{what} is {values!r}, not three finite numbers", "correct it", line=line)
    return array


def _one_line(text: object) -> str:
    return " ".join(str(text).split())


def lost(landmarks: Landmarks, *, descriptions: bool = False, covariances: bool = False) -> tuple[str, ...]:
    """What landmarks have of the things named, as losses."""
    losses = []
    described = sum(map(bool, landmarks.descriptions))
    uncertain = int(np.isfinite(np.asarray(landmarks.covariances)).all(axis=(1, 2)).sum())
    if descriptions and described:
        losses.append(f"the descriptions of {described} landmarks")
    if covariances and uncertain:
        losses.append(f"the uncertainties of {uncertain} landmarks")
    return tuple(losses)


def told(landmarks: Landmarks) -> tuple[Space, tuple[str, ...]]:
    """The space to write into a file that must name one, and a note where it was assumed."""
    if landmarks.space is not None:
        return landmarks.space, ()
    return "RAS", ("nothing said which way x and y point: written as RAS",)
