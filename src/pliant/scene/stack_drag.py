"""The controls of one layer are dragged: points that they reach travel through the layers above, no others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Drag
from pliant.mesh import Points, PolygonMesh
from pliant.scene.layer import Layer, blended
from pliant.scene.stack_step import controls_of
from pliant.scene.turning import turned

if TYPE_CHECKING:
    from pliant.scene.stack import Stack
    from pliant.scene.stack_binding import StackBinding

Rows = NDArray[np.integer] | slice


class LayerDrag:
    """An interaction with one layer of a stack: owns its buffers and keeps them up to date.

    Parameters
    ----------
    binding
        The stack, evaluated.
    name
        The layer whose controls move. While it is left out, its controls move and no point does.
    """

    def __init__(self, binding: StackBinding, name: str) -> None:
        self._binding, self._layer = binding, binding.stack[name]
        inner = binding.bound(name)
        self._controls = np.array(controls_of(self._layer, inner))
        self._drag = inner.drag(self._controls)
        self._heard = self._layer in binding.stack.active
        self._result = np.array(binding.result)
        if self._heard:
            self._stages = self._begun()
            self._alone = len(self._stages) == 1 and self._stages[0].passes  # its points are the stack's

    def _begun(self) -> list[_Stage]:
        steps = list(self._binding._steps.values())
        place = next(i for i, step in enumerate(steps) if step.layer is self._layer)
        added = self._binding.stack.mode == "add"
        mesh = self._binding.target
        first = _Stage(self._layer, steps[place].at, steps[place].below, np.array(steps[place].points), mesh, added)
        if place == 0 and not self._binding._ground.moved:
            first.turns = False  # it stands on the shape at rest
        if added:
            first.points = self._result
            first.below = self._result - first.displacement(self._drag.points)
            return [first]
        stages = [first]
        for step in steps[place + 1 :]:
            stage = _Stage(step.layer, step.at, stages[-1].points, np.array(step.points), mesh, added)
            if not step.layer.in_space:
                stage.own = self._binding.image(step.layer.name)
            stages[-1].kept = stage.turns
            stages.append(stage)
        return stages

    @property
    def points(self) -> Points:
        """(n, 3) the deformed points now: a read-only view of the buffer."""
        if self._heard and self._alone:
            return self._drag.points
        view = (self._stages[-1].points if self._heard else self._result).view()
        view.flags.writeable = False
        return view

    @property
    def inner(self) -> Drag:
        """The drag of the layer's deformer alone."""
        return self._drag

    @property
    def controls(self) -> Controls:
        """Where the layer's controls are now."""
        return self._controls.copy()

    @property
    def stack(self) -> Stack:
        """The stack with the layer's controls where they are now."""
        moved = self._layer.deformer.moved(self._controls)
        return self._binding.stack.replace(self._layer.name, deformer=moved)

    def update(self, controls: ArrayLike, changed: Any = None) -> NDArray[np.integer]:
        """Move the layer's controls.

        Parameters
        ----------
        controls
            All of them, shaped as the deformer's.
        changed
            Indices of those that differ from the last call; None = find out.

        Returns
        -------
        ndarray
            (k,) indices of the points that were recomputed.
        """
        touched = self._drag.update(controls, changed)
        self._controls = np.array(controls, np.float64)
        if not self._heard or not len(touched):
            return np.empty(0, np.int64)
        if self._alone:
            return touched
        rows = _rows(touched, len(self._result))
        here: Points | None = self._stages[0].settle(rows, None, self._drag.points)
        for stage in self._stages[1:]:
            if stage.turns:
                touched = stage.reached(touched)
                rows, here = _rows(touched, len(self._result)), None
            here = stage.settle(rows, here, stage.own)
        return touched


class _Stage:
    """The dragged layer, or one above it: its input, its output, and how to bring some rows of it up to date.

    Rows travel from stage to stage by themselves; only where all points are needed, ``kept``, are they stored.
    """

    def __init__(self, layer: Layer, at: Points, below: Points, points: Points, target: Any, added: bool) -> None:
        self.layer, self.below, self.points = layer, below, points
        self.own: Points | None = None  # where the deformer alone puts the points; None = to be computed
        self.kept = True
        self._rest, self._mesh = at, target
        self._plain = layer.in_space and not added
        self.turns = not layer.in_space and not added and isinstance(target, PolygonMesh)

    @property
    def passes(self) -> bool:
        """Whether its result is its deformer's, whole."""
        strength = self.layer.strength
        return self._plain and not isinstance(strength, np.ndarray) and strength == 1.0

    def displacement(self, image: Points, rows: Rows = slice(None)) -> Points:
        strength = self.layer.strength
        factor = strength[rows, None] if isinstance(strength, np.ndarray) else strength
        return np.asarray(factor * (image[rows] - self._rest[rows]))

    def reached(self, touched: NDArray[np.integer]) -> NDArray[np.integer]:
        """The points that change when some below have: where the surface turns, their neighbours too."""
        if len(touched) == len(self.points):
            return touched
        assert isinstance(self._mesh, PolygonMesh)
        marked = np.zeros(len(self.points), bool)
        marked[touched] = True
        around = self._mesh.edges[marked[self._mesh.edges].any(axis=1)]
        marked[around.reshape(-1)] = True
        return np.flatnonzero(marked)

    def settle(self, rows: Rows, below: Points | None, image: Points | None) -> Points:
        """Bring some rows up to date, and return them.

        Parameters
        ----------
        rows
            Which.
        below
            What the stage below made of them; None = what it has stored.
        image
            (n, 3) where the deformer alone puts the points; None = to be computed.
        """
        if below is None:
            below = self.below[rows]
        if self._plain:
            moved = self.layer.deformer._deformed(below) if image is None else np.array(image[rows])
            strength = self.layer.strength
            here = blended(below, moved, strength[rows] if isinstance(strength, np.ndarray) else strength)
        else:
            assert image is not None
            here = below + self._carried(self.displacement(image, rows), rows)
        if self.kept:
            self.points[rows] = here
        return here

    def _carried(self, displacement: Points, rows: Rows) -> Points:
        """Displacements of the shape at rest, turned as the surface below has turned."""
        if self.turns:
            assert isinstance(self._mesh, PolygonMesh)
            vertices = np.arange(len(self.points)) if isinstance(rows, slice) else rows
            some = np.flatnonzero(displacement.any(axis=1))
            rotation = turned(self._mesh, self.below, np.asarray(vertices[some], np.int64))
            displacement[some] = np.einsum("nij,nj->ni", rotation, displacement[some])
        return displacement


def _rows(touched: NDArray[np.integer], count: int) -> Rows:
    return slice(None) if len(touched) == count else touched
