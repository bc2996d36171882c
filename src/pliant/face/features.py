"""The features of a face: which landmarks are moved, and by which handle.

A handle is a name and the landmarks that it takes along, wholly or in part: along the lips, the lids and the outline
the part that one handle has fades as that of the next grows. Groups are sets of handles. Right and left are the
subject's; only the right half and the middle are listed, the left half is its mirror image.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.face.topology import opposite

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_SIMPLE: dict[str, tuple[int, ...]] = {
    "right brow outer": (70, 63, 105),
    "right brow inner": (66, 107),
    "nose bridge": (168, 197),
    "nose tip": (4, 2),
    "nose wings": (64, 294),
    "chin": (199, 200),
    "right cheek": (50, 205, 117),
    "forehead": (151, 69),
}
_LIPS = (  # from the middle of the upper lip by the right corner to the middle of the lower, outermost first
    (0, 37, 39, 40, 185, 61, 146, 91, 181, 84, 17),
    (11, 72, 73, 74, 184, 76, 77, 90, 180, 85, 16),
    (12, 38, 41, 42, 183, 62, 96, 89, 179, 86, 15),
    (13, 82, 81, 80, 191, 78, 95, 88, 178, 87, 14),
)
_UPPER_LID = (33, 246, 161, 160, 159, 158, 157, 173, 133)  # from the outer corner to the inner
_LOWER_LID = (33, 7, 163, 144, 145, 153, 154, 155, 133)
_OUTLINE = (10, 109, 67, 103, 54, 21, 162, 127, 234, 93, 132, 58, 172, 136, 150, 149, 176, 148, 152)
_ALONG_OUTLINE = (  # which handle has all of the outline, at which step from the forehead to the chin
    *((0, "forehead"), (2, "forehead"), (6, "right temple"), (8, "right temple")),
    *((12, "right jaw"), (13, "right jaw"), (16, "chin"), (18, "chin")),
)

GROUPS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "brows": ("right brow outer", "right brow inner", "left brow outer", "left brow inner"),
        "eyes": (
            *("right upper lid", "right lower lid", "right eye corners"),
            *("left upper lid", "left lower lid", "left eye corners"),
        ),
        "nose": ("nose bridge", "nose tip", "nose wings"),
        "mouth": ("upper lip", "lower lip", "mouth right corner", "mouth left corner"),
        "chin": ("chin",),
        "cheeks": ("right cheek", "left cheek"),
        "outline": ("forehead", "right temple", "left temple", "right jaw", "left jaw"),
    }
)
HANDLES: tuple[str, ...] = tuple(handle for handles in GROUPS.values() for handle in handles)
GROUP_OF_HANDLE: Indices = np.repeat(np.arange(len(GROUPS)), [len(handles) for handles in GROUPS.values()])


@cache
def sites() -> tuple[Indices, Floats]:
    """(k,) the landmarks that handles move, and (k, h) the part that each handle has in each; rows sum to one."""
    parts: dict[tuple[int, str], float] = {}
    for handle, landmarks in _SIMPLE.items():
        parts |= {(landmark, handle): 1.0 for landmark in landmarks}
    for ring in _LIPS:
        for step, landmark in enumerate(ring):
            corner = _fade(1 - abs(step - 5) / 5)
            parts[landmark, "mouth right corner"] = corner
            parts[landmark, "upper lip" if step < 5 else "lower lip"] = 1 - corner
    for name, lid in (("upper lid", _UPPER_LID), ("lower lid", _LOWER_LID)):
        for step, landmark in enumerate(lid):
            middle = float(np.sin(np.pi * step / 8))
            parts[landmark, "right eye corners"] = 1 - middle
            parts[landmark, f"right {name}"] = middle
    for (start, first), (stop, second) in pairwise(_ALONG_OUTLINE):
        for step in range(start, stop + 1):
            part = _fade((step - start) / (stop - start))
            parts[_OUTLINE[step], first] = 1 - part
            parts[_OUTLINE[step], second] = part if second != first else 1.0
    parts |= {(int(opposite()[landmark]), _across(handle)): part for (landmark, handle), part in parts.items()}
    chosen = np.unique([landmark for landmark, _ in parts])
    table = np.zeros((len(chosen), len(HANDLES)))
    for (landmark, handle), part in parts.items():
        table[np.searchsorted(chosen, landmark), HANDLES.index(handle)] = part
    return chosen, table


@cache
def group_of_sites() -> Floats:
    """(k, g) the part that each group has in each landmark that handles move."""
    return np.asarray(sites()[1] @ np.eye(len(GROUPS))[GROUP_OF_HANDLE])


def handles_of(name: str) -> list[int]:
    """The handles of a name: a handle's own, or a group's.

    Raises
    ------
    InvalidParameter
        Neither has this name.
    """
    if name in HANDLES:
        return [HANDLES.index(name)]
    if name in GROUPS:
        return [HANDLES.index(handle) for handle in GROUPS[name]]
    raise InvalidParameter(
        f"no part of a face is called {name!r}; there are the groups {', '.join(GROUPS)}, and the handles "
        f"{', '.join(HANDLES)}"
    )


def _across(handle: str) -> str:
    """The handle on the other side."""
    words = {"right": "left", "left": "right"}
    return " ".join(words.get(word, word) for word in handle.split(" "))


def _fade(part: float) -> float:
    """From 0 to 1 without a kink at either end."""
    return part * part * (3 - 2 * part)
