"""Bindings whose points come out of an iteration: they give an account of it, and a drag goes on from where it was."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Drag
from pliant.mesh import Points


@dataclass(frozen=True, eq=False)
class Solution:
    """Where an iteration ended.

    Parameters
    ----------
    points
        (n, 3) the deformed points.
    status
        ``"converged"``, or ``"stopped"`` at the largest number of iterations.
    energies
        (iterations + 1,) what was minimised: at the beginning, and after each iteration.
    """

    points: Points
    status: Literal["converged", "stopped"]
    energies: NDArray[np.float64]

    @property
    def iterations(self) -> int:
        """How many it took."""
        return len(self.energies) - 1

    @property
    def energy(self) -> float:
        """What is left of the energy."""
        return float(self.energies[-1])


class IterativeBinding(Binding):
    """A binding that iterates. Stopping early is a status, not an error."""

    @abstractmethod
    def solve(
        self, controls: ArrayLike | None = None, start: Points | None = None, *, iterations: int | None = None
    ) -> Solution:
        """As :meth:`deform`, with an account of the iteration.

        Parameters
        ----------
        controls
            Shaped as :attr:`rest`; None = the deformer's own.
        start
            (n, 3) where to begin; None = a guess from the controls, as :meth:`deform` does.
        iterations
            How many at most; None = as many as the deformer says.
        """

    def drag(self, controls: ArrayLike | None = None) -> IterativeDrag:
        return IterativeDrag(self, controls)


class IterativeDrag(Drag):
    """A drag that begins each iteration where the last one ended; ``solution`` is the last one's account.

    ``iterations`` limits each update: then an update with the same controls goes on, until it has converged.
    """

    def __init__(self, binding: IterativeBinding, controls: ArrayLike | None = None) -> None:
        self._iterative = binding
        super().__init__(binding, controls)
        self.solution: Solution | None = None
        self.iterations: int | None = None
        self._start: Points | None = None

    def resume(self, points: Points) -> None:
        """Let the next iteration begin at (n, 3) points, such as another method's."""
        self._start, self.solution = points, None

    def update(self, controls: ArrayLike, changed: Any = None) -> NDArray[np.integer]:
        new = self._binding._checked(controls)
        if np.array_equal(new, self._controls) and not self._unsettled:
            return np.empty(0, np.int64)
        start = self._buffer if self._start is None else self._start
        self.solution = self._iterative.solve(new, start=start, iterations=self.iterations)
        touched = np.flatnonzero((self.solution.points != self._buffer).any(axis=1))
        self._buffer[touched] = self.solution.points[touched]
        self._controls, self._start = new.copy(), None
        return touched

    @property
    def _unsettled(self) -> bool:
        """Whether there is more to do, though the controls are where they were."""
        if self._start is not None:
            return True
        return self.iterations is not None and self.solution is not None and self.solution.status == "stopped"
