"""What a reader keeps of a zxhproj file, so that it can be written again as it was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.io.map_formats.lattice_frame import LatticeFrame

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FFDHeader:
    """What an ``.FFD`` file says beside its map.

    Parameters
    ----------
    variant, reason
        The layout, and why it was taken.
    dimension
        2 or 3, as the file says.
    coordinates
        How many numbers size and spacing have, and how many an offset has.
    one_to_one, quaternion
        The text of these blocks; None where there is no quaternion.
    frame
        Where the file says that the lattice lies.
    offsets
        (nx, ny, nz, 3) along the lattice axes, as they were read.
    """

    variant: str
    reason: str
    dimension: int
    coordinates: tuple[int, int]
    one_to_one: str
    quaternion: str | None
    frame: LatticeFrame
    offsets: Floats


@dataclass(frozen=True, eq=False)
class AFFHeader:
    """What an ``.AFF`` file says beside its matrix.

    Parameters
    ----------
    matrix
        (4, 4) as it was read.
    parameters
        The text of all blocks, by name: rotation angle, scaling, ...
    data
        The whole file.
    """

    matrix: Floats
    parameters: Mapping[str, str]
    data: bytes
