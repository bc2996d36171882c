"""A handle is dragged by the gizmo: a map of what is seen, applied to the handle, and the surface follows.

An edit is bound to the shape at rest, while people drag it where they see it: behind the layers below, which have
turned it. So the map is applied to where the handle is seen, and what has moved is turned back.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Controls
from pliant.errors import InvalidParameter
from pliant.iterative import IterativeDrag
from pliant.mesh import Points
from pliant.scene.stack import Stack
from pliant.scene.stack_drag import LayerDrag
from pliant.scene.turning import turned
from pliant.studio.dragging import Dragging
from pliant.studio.modes.layering import with_layer
from pliant.studio.modes.method_switch import (
    Preparation,
    at_rest,
    by_method,
    edit_of,
    known_method,
    method_of,
    takes_long,
)
from pliant.studio.modes.skeletons import followed_skeleton
from pliant.studio.request import Client, Request
from pliant.surface.arap import ARAP

if TYPE_CHECKING:
    from pliant.studio.session import Session

_PATIENCE = 0.028  # seconds of iterating in an answer: what is left of 50 goes into drawing
_FIRST = 2  # iterations, before it is known how long one takes
_MOST = 40
_LONG = 2000  # vertices of a region: with fewer, the rest is iterated before the answer


class SurfaceDrag(Dragging):
    """A handle follows the gizmo.

    Parameters
    ----------
    session, client
        As for every drag.
    layer
        The layer that is dragged; empty where one is made.
    method
        By which the surface shall follow: as soon as it is bound.
    structure
        Region and handle of a layer that is made.

    Attributes
    ----------
    method
        By which the surface follows now.
    coming
        What is being bound for this drag; None = nothing.
    """

    def __init__(
        self,
        session: Session,
        client: Client,
        layer: str,
        method: str,
        structure: tuple[NDArray[np.int64], NDArray[np.int64]] | None,
    ) -> None:
        stack = session.required.stack
        kind = known_method(method)
        if structure is not None:
            stack, layer = with_layer(stack, "Edit", kind(*structure))
            if takes_long(session, stack, layer):
                stack = by_method(stack, layer, "laplacian")
        super().__init__(session, client, layer, "edit", stack)
        deformer = edit_of(stack, layer)
        self._session, self._per_step = session, 0.0
        self.method = method_of(deformer)
        self.coming: Preparation | None = None
        goal = deformer.goal
        binding = session.shown.binding.updated(stack)
        bound = binding.bound(layer)
        self._begin(at_rest(stack, layer))
        self._goal: Controls = np.array(bound.rest if goal is None else goal)
        if goal is not None and isinstance(self._drag.inner, IterativeDrag):
            self._drag.inner.resume(binding.image(layer))
        self._see(binding.below(layer), binding.bound(layer).rest)
        self._follow(method)

    def _begin(self, stack: Stack) -> None:
        """Drag from the edit at rest: the first update moves all that it has moved before."""
        self._drag: LayerDrag = self._session.shown.binding.updated(stack).drag_layer(self.layer)

    def _see(self, below: Points, rest: Points) -> None:
        """Where the handle is seen, and how it is turned there."""
        stage = self._session.shown
        deformer = edit_of(self._drag.stack, self.layer)
        handle = np.arange(len(below))[np.asarray(deformer.handle)]
        self._rest, self._below = rest, below[handle]
        mesh = stage.scene.mesh
        plain = below is mesh.points or self._drag.stack.mode == "add" or np.array_equal(below, mesh.points)
        self._turns = None if plain else turned(mesh, below, handle)
        strength = self._drag.stack[self.layer].strength
        share = strength[handle] if isinstance(strength, np.ndarray) else np.full(len(handle), strength)
        self._share = np.where(np.abs(share) < 1e-3, 1.0, share)[
            :, None
        ]  # what is left out is dragged as if it were not
        move = self._share * (self._goal - rest)
        self._seen = self._below + (move if self._turns is None else np.einsum("nij,nj->ni", self._turns, move))

    def _moved(self, matrix: NDArray[np.float64]) -> Controls:
        """(h, 3) controls that put the handle where a map of what is seen does."""
        to = self._seen @ matrix[:3, :3].T + matrix[:3, 3] - self._below
        back = to if self._turns is None else np.einsum("nji,nj->ni", self._turns, to)
        return np.asarray(self._rest + back / self._share)

    def _follow(self, method: str) -> None:
        """Go on by a method, now or as soon as it is bound; where that is given up, by the one before."""
        known_method(method)
        if self.coming is not None and self.coming.method != method:
            self.give_up()
        if method == self.method:
            return
        if self.coming is None:
            stack = at_rest(by_method(self._drag.stack, self.layer, method), self.layer)
            if takes_long(self._session, stack, self.layer):
                self.coming = Preparation(self._session, method, stack, self.layer)
                return
        if self.coming is None or self.coming.arrived:
            self._switch(method)
            self.coming = None

    def give_up(self) -> None:
        """Wait for no other method."""
        if self.coming is not None:
            self.coming.stop()
            self.coming = None

    def _switch(self, method: str) -> None:
        """Another method, from where this one has arrived."""
        before = self._drag
        arrived = np.array(before.inner.points)
        self._begin(at_rest(by_method(before.stack, self.layer, method), self.layer))
        self.method, self._per_step = method, 0.0
        if isinstance(self._drag.inner, IterativeDrag) and isinstance(edit_of(self._drag.stack, self.layer), ARAP):
            self._drag.inner.resume(arrived)

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        self._follow(request.text("method", self.method))
        if "matrix" in request.arrays:
            matrix = np.asarray(request.array("matrix"), np.float64)
            if matrix.size != 16:
                raise InvalidParameter(f"a map of the handle has 16 numbers; given: {matrix.size}")
            self._goal = self._moved(matrix.reshape(4, 4).T)
        return self._updated()

    def _updated(self) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        arrays: dict[str, NDArray[Any]] = {}
        if isinstance(self._drag.inner, IterativeDrag) and self.method == "arap":
            touched = self._converge(self._drag.inner, arrays)
        else:
            touched = self._drag.update(self._goal)
        skeleton = followed_skeleton(self._session, self._drag.points)
        if skeleton is not None:
            arrays["skeleton"] = skeleton
        return touched, self._drag.points, arrays

    def _converge(self, inner: IterativeDrag, arrays: dict[str, NDArray[Any]]) -> NDArray[np.integer]:
        """As many iterations as an answer has time for, told with their energies."""
        inner.iterations = _FIRST if not self._per_step else int(np.clip(_PATIENCE / self._per_step, 1, _MOST))
        began = time.perf_counter()
        touched = self._drag.update(self._goal)
        if len(touched) and inner.solution is not None:
            self._per_step = (time.perf_counter() - began) / (inner.solution.iterations + 1)
            arrays["energies"] = inner.solution.energies
            arrays["converged"] = np.array([inner.solution.status == "converged"], np.uint8)
        return touched

    def suppose(self) -> bool:
        """Whether what is left of the iteration is long: then where it has arrived stands for its end."""
        layer, inner = self.stack[self.layer], self._drag.inner
        edit = edit_of(self.stack, self.layer)
        short = np.arange(len(inner.points))[np.asarray(edit.roi)].size < _LONG
        if self.method != "arap" or short or not isinstance(inner, IterativeDrag) or inner.solution is None:
            return False
        self._session.shown.binding.suppose(layer, inner.points)
        return True

    @property
    def stack(self) -> Stack:
        return self._drag.stack.replace(self.layer, deformer=edit_of(self._drag.stack, self.layer).moved(self._goal))
