"""What can be taken hold of: a few numbers of a deformer, and the place that follows from them.

Dragging a handle finds the numbers at which its place lies under the pointer
(:mod:`pliant.studio.modes.axial.following`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.studio.modes.axial.tool import Tool

Floats = NDArray[np.float64]
Unit = Literal["radians", "factor", "length", "place", "direction"]
Place = Callable[[Tool], Points]


@dataclass(frozen=True)
class Handle:
    """Something to take hold of.

    Parameters
    ----------
    name
        Of the field, or of the bound, that it sets.
    unit
        What its numbers are.
    read
        (k,) the numbers of a tool.
    write
        A tool with other numbers.
    place
        (1, 3) where a tool's handle is.
    says
        What stands beside it; None = its first number.
    """

    name: str
    unit: Unit
    read: Callable[[Tool], Floats]
    write: Callable[[Tool, Floats], Tool]
    place: Place
    says: Callable[[Tool], float] | None = None

    def value(self, tool: Tool) -> float:
        """What stands beside it."""
        return float(self.read(tool)[0]) if self.says is None else self.says(tool)
