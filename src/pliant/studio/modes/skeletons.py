"""The contour skeleton that pages show: computed once in the background, and then carried along by what moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pliant.mesh import Points
from pliant.studio.serving.frames import Frame
from pliant.surface.contour_skeletons import ContourSkeleton, known_skeleton

if TYPE_CHECKING:
    from pliant.studio.session import Session

_KEY = "skeleton"


@dataclass(frozen=True)
class ShownSkeleton:
    """A skeleton of the shape at rest, and what it was made with."""

    contours: int
    eigenvectors: int
    skeleton: ContourSkeleton


def show_skeleton(session: Session, contours: int, eigenvectors: int) -> bool:
    """Whether the skeleton is known; else it is begun, and pages are told of it when it is."""
    mesh, beside = session.required.mesh, session.beside
    known: ShownSkeleton | None = beside.get(_KEY)
    if known is not None and (known.contours, known.eigenvectors) == (contours, eigenvectors):
        return True

    def done(found: ContourSkeleton) -> None:
        if session.scene is not None and session.scene.mesh is mesh:
            session.beside[_KEY] = ShownSkeleton(contours, eigenvectors, found)
            session.broadcast(skeleton_frame(session))

    session.jobs.run("Skeleton", lambda _: known_skeleton(mesh, contours, None, eigenvectors), done)
    return False


def skeleton_frame(session: Session) -> Frame:
    """The skeleton as the shape is now: points, the links between them, and the group of each vertex."""
    known: ShownSkeleton = session.beside[_KEY]
    points = followed_skeleton(session, session.shown.binding.result)
    assert points is not None
    arrays: dict[str, NDArray[Any]] = {
        "points": points,
        "links": known.skeleton.links.astype(np.uint32),
        "groups": known.skeleton.groups.astype(np.int32),
    }
    head = {"event": "skeleton", "contours": known.contours, "eigenvectors": known.eigenvectors}
    return Frame(head, arrays)


def followed_skeleton(session: Session, points: Points) -> NDArray[np.float64] | None:
    """(g, 3) where the skeleton's points are when the shape's are at (n, 3); None where none is shown."""
    known: ShownSkeleton | None = session.beside.get(_KEY)
    if known is None:
        return None
    return known.skeleton.following(points - session.required.mesh.points)
