"""Another method for an edit of the surface: on a large mesh it is bound beside the session, while the drag goes on.

To bind may take seconds: a skeleton's eigenvectors, the factor of a large region. Until that has ended, or for good
where somebody stops it, the edit goes on by the method that it has.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from pliant.errors import InvalidParameter
from pliant.scene.stack import Stack
from pliant.surface.arap import ARAP
from pliant.surface.editing import SurfaceDeformer
from pliant.surface.laplacian_edit import LaplacianEdit
from pliant.surface.skeleton_edit import SkeletonEdit

if TYPE_CHECKING:
    from pliant.studio.session import Session

METHODS: dict[str, type[SurfaceDeformer]] = {"laplacian": LaplacianEdit, "arap": ARAP, "skeleton": SkeletonEdit}

_TITLES = {"laplacian": "Laplacian", "arap": "ARAP", "skeleton": "Skeleton"}
_LARGE = 4000  # points of a mesh: with fewer, nobody notices


class Preparation:
    """A method that is being bound.

    Parameters
    ----------
    session
        Where it will be used.
    method
        Which.
    stack, layer
        A layer of that method.
    then
        Called on the session's thread when it is bound.

    Attributes
    ----------
    arrived
        Whether it is bound.
    """

    def __init__(
        self, session: Session, method: str, stack: Stack, layer: str, then: Callable[[], None] = lambda: None
    ) -> None:
        self.method, self.arrived = method, False
        self._session, self._then = session, then
        binding = session.shown.binding
        self._job = session.jobs.run(_TITLES[method], lambda _: binding.updated(stack).bound(layer), self._arrive)

    @property
    def name(self) -> str:
        """Of the job, as pages know it."""
        return self._job.name

    @property
    def given_up(self) -> bool:
        """Whether somebody has stopped it, or it could not be done."""
        return self._job.stopped.is_set() and not self.arrived

    def stop(self) -> None:
        """Nobody waits for it any more."""
        self._session.jobs.stop(self._job.name)

    def _arrive(self, _: object) -> None:
        self.arrived = True
        self._then()


def takes_long(session: Session, stack: Stack, layer: str) -> bool:
    """Whether a layer of a stack is to be bound first, and its mesh is large."""
    return len(session.required.mesh.points) > _LARGE and not session.shown.binding.has_bound(stack[layer])


def by_method(stack: Stack, layer: str, method: str) -> Stack:
    """The stack with the same edit by another method."""
    deformer = edit_of(stack, layer)
    made = known_method(method)(deformer.roi, deformer.handle, goal=deformer.goal)
    return stack.replace(layer, deformer=made)


def exchange(session: Session, layer: str, method: str) -> Preparation | None:
    """Commit the same edit by another method: at once, or when it is bound; then that is what is given."""
    stack = by_method(session.required.stack, layer, method)
    structure = stack[layer].structure
    if not takes_long(session, stack, layer):
        session.drop_drag()
        session.commit(session.required.replace(stack=stack), "method", layer)
        return None

    def then() -> None:
        scene = session.scene
        if session.dragging is not None or scene is None or layer not in scene.stack.names:
            return  # who drags this layer meanwhile asks for the method again
        if isinstance(scene.stack[layer].deformer, SurfaceDeformer):
            now = by_method(scene.stack, layer, method)
            if now[layer].structure == structure:
                session.commit(scene.replace(stack=now), "method", layer)

    return Preparation(session, method, stack, layer, then)


def known_method(method: str) -> type[SurfaceDeformer]:
    """The deformer of a method.

    Raises
    ------
    InvalidParameter
        There is no such method.
    """
    if method not in METHODS:
        raise InvalidParameter(f"no method is called {method!r}; there are: {', '.join(METHODS)}")
    return METHODS[method]


def method_of(deformer: SurfaceDeformer) -> str:
    """What a deformer's method is called here."""
    return next(name for name, kind in METHODS.items() if isinstance(deformer, kind))


def edit_of(stack: Stack, layer: str) -> SurfaceDeformer:
    """The deformer of a layer that edits the surface.

    Raises
    ------
    InvalidParameter
        The layer is of another kind.
    """
    deformer = stack[layer].deformer
    if not isinstance(deformer, SurfaceDeformer):
        raise InvalidParameter(f"layer {layer!r} has no region and no handle: choose one that edits the surface")
    return deformer


def at_rest(stack: Stack, layer: str) -> Stack:
    """The stack before anybody has moved the handle of an edit."""
    return stack.replace(layer, deformer=replace(edit_of(stack, layer), goal=None))
