"""What bindings keep that know their points, and where their controls rest and stood."""

from __future__ import annotations

from pliant.deformer import Binding, Controls
from pliant.mesh import Points


class PointBinding(Binding):
    """A binding of points to controls that are positions.

    Parameters
    ----------
    points
        (n, 3) the target's.
    rest, controls
        (m, 3) the controls at rest; where they were when it was bound.
    """

    def __init__(self, points: Points, rest: Controls, controls: Controls) -> None:
        self._points, self._rest, self._controls = points, rest, controls

    @property
    def rest(self) -> Controls:
        """(m, 3) the controls at rest."""
        return self._rest
