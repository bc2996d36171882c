"""Looking at the deformation: lines of a warped grid, arrows, colours on the surface, folds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.deformer import Deformer, SpaceDeformer
from pliant.errors import InvalidParameter
from pliant.field.grids import AXES, WarpedGrid, field_grid
from pliant.field.limiting import limit_to_fold_free
from pliant.field.vectors import arrows
from pliant.mesh import Points
from pliant.numerics.coordinates.parity import inside
from pliant.numerics.ragged import Ragged
from pliant.rendering.palette import SEQUENTIAL, color_table
from pliant.space.bezier_ffd import BezierFFD
from pliant.space.bspline_ffd import BSplineFFD
from pliant.studio.request import Request, command
from pliant.studio.seen.quantities import quantity
from pliant.studio.seen.spaces import space_map
from pliant.studio.serving.frames import Frame
from pliant.studio.session import Session

_MOST_LINES = 64
_ROOM = 0.06  # around the shape, as part of its extent
MARGIN = 1e-3  # of det J, left when a fold is taken back


@command("field.lines")
def lines(session: Session, request: Request) -> Frame:
    """The lines of a grid, warped as the shape is."""
    scene = session.required
    density = min(max(request.integer("density", 12), 2), _MOST_LINES)
    low, high = _room(scene.mesh.bounds)
    spacing = float((high - low).max()) / density
    where = request.text("slice", "box")
    planes = None
    if where != "box":
        if where not in AXES or len(where) != 1:
            raise InvalidParameter(f"a slice is x, y, z or box; given: {where!r}")
        axis = AXES.index(where)
        planes = {where: float(low[axis] + request.number("at", 0.5) * (high[axis] - low[axis]))}
    grid = field_grid(_moved(session), (low, high), spacing, planes=planes)
    if request.values.get("inside"):
        grid = _kept(grid, inside(grid.rest, scene.mesh.points, scene.mesh.triangles))
    return Frame({}, {"points": grid.points.astype(np.float32), "offsets": grid.lines.offsets.astype(np.uint32)})


@command("field.arrows")
def show_arrows(session: Session, request: Request) -> Frame:
    """Arrows from where points of space were to where they go."""
    density = min(max(request.integer("density", 12), 2), 24)
    low, high = _room(session.required.mesh.bounds)
    found = arrows(_moved(session), (low, high), float((high - low).max()) / density)
    table = np.rint(255 * color_table(SEQUENTIAL)).astype(np.uint8)
    arrays = {"positions": found.positions.astype(np.float32), "vectors": found.vectors.astype(np.float32)}
    return Frame({}, {**arrays, "table": table})


@command("field.color")
def color(session: Session, request: Request) -> Frame:
    """A number at each vertex, and the colours that it stands for."""
    scene, stage = session.required, session.shown
    chosen = quantity(request.text("quantity"))
    points = stage.binding.result
    dragging = session.dragging
    stack = scene.stack if dragging is None else dragging.stack
    if dragging is not None:
        points = stage.binding.updated(stack).result
    after = scene.mesh.with_points(points)
    deformer = stack if any(not layer.in_space for layer in stack.active) else space_map(stack)
    values = chosen.values(scene.mesh, after, deformer)
    low, high = chosen.limits(values)
    head = {"low": low, "high": high, "unit": chosen.unit}
    return Frame(head, {"values": values.astype(np.float32), "table": chosen.table})


@command("field.limit")
def limit(session: Session, request: Request) -> None:
    """Make the deformation smaller, until it does not fold any more: the layer that folds, in the background."""
    scene = session.required
    folding = [layer for layer in scene.stack.active if isinstance(layer.deformer, BSplineFFD | BezierFFD)]
    if not folding:
        raise InvalidParameter("only lattices can be reduced until they do not fold")
    layer = folding[-1]
    lattice = layer.deformer
    assert isinstance(lattice, BSplineFFD | BezierFFD)

    def done(safe: Deformer) -> None:
        if session.scene is scene:
            stack = scene.stack.replace(layer.name, deformer=safe)
            session.commit(scene.replace(stack=stack), "limit", layer.name)

    session.jobs.run(layer.name, lambda _: limit_to_fold_free(lattice, margin=MARGIN), done)


def _moved(session: Session) -> SpaceDeformer:
    stack = session.required.stack if session.dragging is None else session.dragging.stack
    return space_map(stack)


def _room(bounds: tuple[Points, Points]) -> tuple[Points, Points]:
    """A box a little larger than the shape's."""
    low, high = bounds
    room = _ROOM * np.maximum(high - low, 0.05 * float((high - low).max()))
    return low - room, high + room


def _kept(grid: WarpedGrid, kept: NDArray[np.bool_]) -> WarpedGrid:
    """The pieces of the lines whose points are inside."""
    rows = []
    for line in grid.lines:
        chosen = kept[line]
        cuts = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
        rows += [line[start:stop] for start, stop in cuts.reshape(-1, 2) if stop - start > 1]
    order = np.concatenate([np.empty(0, np.int32), *rows])
    lengths = np.array([len(row) for row in rows], np.int64)
    lines = Ragged(np.arange(len(order), dtype=np.int32), np.concatenate([[0], np.cumsum(lengths)]))
    return WarpedGrid(grid.rest[order], grid.points[order], lines)
