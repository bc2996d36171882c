"""A plane becomes a Bézier surface, and what stands on it is carried along (the 2-D lattices of Coquillart 1990)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Binding, Controls, Target, checked_controls, checked_out
from pliant.errors import InvalidDeformer, OutsideDomain
from pliant.mesh import Points, PolygonMesh, as_points
from pliant.numerics.compute.chunks import for_chunks
from pliant.numerics.given import as_numbers
from pliant.numerics.lattices.patch_surface import PatchSurface, bernstein_sum, bernstein_transpose
from pliant.numerics.ragged import frozen
from pliant.space.bezier_ffd import TOLERANCE, Outside
from pliant.space.box import box_around, checked_counts, thickened
from pliant.space.control_lattice import ControlLattice

Floats = NDArray[np.float64]

AXES = {"x": [1, 2, 0], "y": [2, 0, 1], "z": [0, 1, 2]}
CHUNK = 8192


@dataclass(frozen=True, eq=False, kw_only=True)
class BezierPatchFFD(ControlLattice):
    """Free-form deformation of a plane into a Bézier surface of any degree (Coquillart 1990).

    A point X = origin + s S + t T + h N, with N the plane's unit normal, moves to P(s, t) + h n(s, t): P is the
    surface, n its unit normal. Points off the plane thus keep their distance from it, along the normal. Where the
    surface has no normal, that of the plane is taken.

    Parameters
    ----------
    displacements
        (l + 1, m + 1, 1, 3) displacement of each control point.
    origin
        (3,) corner of the parallelogram.
    edges
        (3, 2) its edges S and T.
    outside
        What happens to points above or below no part of the parallelogram: ``"identity"`` they stay, ``"extend"``
        the polynomials go on, ``"error"`` they are refused.

    Raises
    ------
    InvalidDeformer
        Edges that do not span a plane, an array of another shape, values that are not finite.
    """

    displacements: Controls
    origin: Floats
    edges: Floats
    outside: Outside = "identity"

    def __post_init__(self) -> None:
        values = {
            name: as_numbers(f"the patch's {name}", getattr(self, name), InvalidDeformer)
            for name in ("displacements", "origin", "edges")
        }
        moves = values["displacements"]
        if moves.ndim != 4 or moves.shape[2:] != (1, 3) or min(moves.shape[:2]) < 2:
            raise InvalidDeformer(f"displacements have shape {moves.shape}; (l, m, 1, 3) is needed, l and m from 2 on")
        if values["origin"].shape != (3,) or values["edges"].shape != (3, 2):
            raise InvalidDeformer("origin and edges must have shapes (3,) and (3, 2)")
        if not all(np.isfinite(value).all() for value in values.values()):
            raise InvalidDeformer("the patch has values that are not finite")
        lengths = np.linalg.norm(values["edges"], axis=0)
        if not (lengths > 0).all() or np.linalg.norm(np.cross(*(values["edges"] / lengths).T)) < 1e-9:
            raise InvalidDeformer(f"the patch's edges do not span a plane: {values['edges'].T.tolist()}")
        if self.outside not in ("identity", "extend", "error"):
            raise InvalidDeformer(f"outside is {self.outside!r}; it must be 'identity', 'extend' or 'error'")
        for name, value in values.items():
            object.__setattr__(self, name, frozen(value, np.float64))

    @classmethod
    def around(
        cls,
        target: PolygonMesh | ArrayLike,
        axis: Literal["x", "y", "z"] = "z",
        shape: tuple[int, int] = (4, 4),
        margin: float = 0.0,
        outside: Outside = "identity",
    ) -> BezierPatchFFD:
        """A patch at rest in the middle of a shape's bounding box.

        Parameters
        ----------
        target
            A mesh or (n, 3) points.
        axis
            The plane's normal.
        shape
            Numbers of control points along the two other axes, the degrees plus one.
        margin
            How much to grow the patch on every side, as a part of its size.
        outside
            What happens to points beside it.

        Raises
        ------
        InvalidDeformer
            An unknown axis, or fewer than two control points along an edge.
        InvalidTarget
            No points.
        """
        if axis not in AXES:
            raise InvalidDeformer(f"axis is {axis!r}; it must be 'x', 'y' or 'z'")
        if min(checked_counts(shape, 2)) < 2:
            raise InvalidDeformer(f"a patch needs two control points or more along both edges; its shape is {shape}")
        frame = np.eye(3)[:, AXES[axis]]
        origin, extent = box_around(target, frame, margin)
        thick = thickened(extent)
        thick[2] = 0.0
        start = origin + frame @ ((extent - thick) / 2)
        return cls(
            displacements=np.zeros((*shape, 1, 3)), origin=start, edges=frame[:, :2] * thick[:2], outside=outside
        )

    @cached_property
    def rest(self) -> Controls:
        """(l + 1, m + 1, 1, 3) positions of the control points at rest."""
        s, t = (np.linspace(0, 1, n) for n in self.displacements.shape[:2])
        grid = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1)[:, :, None]
        return frozen(self.origin + grid @ self.edges.T, np.float64)

    def bind(self, target: Target) -> PatchBinding:
        return PatchBinding(self, as_points(target))

    def jacobian(self, points: ArrayLike) -> Floats:
        at = as_points(points)
        result = np.tile(np.eye(3), (len(at), 1, 1))
        inside, parameters = self.parameters(at)
        surface = PatchSurface.at(self.edges, self.normal, parameters, self.displacements, second=True)
        height = parameters[:, 2, None]
        columns = [
            surface.s + height * surface.turned(surface.ss, surface.st),
            surface.t + height * surface.turned(surface.st, surface.tt),
            surface.normal,
        ]
        result[inside] = np.stack(columns, axis=-1) @ self.inverse_frame
        return result

    @cached_property
    def normal(self) -> Floats:
        """(3,) the plane's unit normal."""
        normal = np.cross(*self.edges.T)
        return np.asarray(normal / np.linalg.norm(normal))

    @cached_property
    def inverse_frame(self) -> Floats:
        """(3, 3) from positions relative to the origin to parameters s, t and height."""
        return np.asarray(np.linalg.inv(np.column_stack([self.edges, self.normal])))

    def parameters(self, points: Points) -> tuple[NDArray[np.int64], Floats]:
        """The points that the patch moves, and their (k, 3) parameters s, t and height.

        Parameters
        ----------
        points
            (n, 3) points of space.

        Raises
        ------
        OutsideDomain
            Some lie beside the patch, and ``outside`` is ``"error"``.
        """
        parameters = (points - self.origin) @ self.inverse_frame.T
        if self.outside == "extend":
            return np.arange(len(points)), parameters
        within = ((parameters[:, :2] >= -TOLERANCE) & (parameters[:, :2] <= 1 + TOLERANCE)).all(axis=1)
        if self.outside == "error" and not within.all():
            beside = np.flatnonzero(~within)
            raise OutsideDomain(
                f"{len(beside):,} of {len(points):,} points are beside the patch, the first is point {beside[0]}: "
                "widen it with margin=, or pass outside='identity' or 'extend'"
            )
        inside = np.flatnonzero(within)
        return inside, parameters[inside]


class PatchBinding(Binding):
    """Points with their parameters on a patch; not linear in the controls, as normals turn."""

    def __init__(self, patch: BezierPatchFFD, points: Points) -> None:
        self._patch, self._points = patch, points
        self._inside, self._parameters = patch.parameters(points)

    @property
    def rest(self) -> Controls:
        return self._patch.rest

    @property
    def controls(self) -> Controls:
        return self._patch.controls

    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        moves, target = self._moves(controls), checked_out(out, len(self._points))
        target[:] = self._points

        def work(start: int, stop: int) -> None:
            part = self._parameters[start:stop]
            surface = self._surface(part, moves)
            target[self._inside[start:stop]] += surface.shift + part[:, 2:] * (surface.normal - self._patch.normal)

        for_chunks(work, len(self._inside), CHUNK)
        return target

    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        surface = self._surface(self._parameters, self._moves(controls))
        tangent, at = checked_controls(d_controls, self.rest.shape), self._parameters
        turned = surface.turned(bernstein_sum(at, tangent, 1, 0), bernstein_sum(at, tangent, 0, 1))
        result = np.zeros_like(self._points)
        result[self._inside] = bernstein_sum(at, tangent, 0, 0) + at[:, 2:] * turned
        return result

    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        surface, at = self._surface(self._parameters, self._moves(controls)), self._parameters
        gradient = checked_controls(d_points, self._points.shape)[self._inside]
        turning = at[:, 2:] * surface.across(gradient) / surface.length
        shape = self.rest.shape
        pulled = bernstein_transpose(at, gradient, shape, 0, 0)
        pulled += bernstein_transpose(at, np.cross(surface.t, turning), shape, 1, 0)
        return pulled + bernstein_transpose(at, np.cross(turning, surface.s), shape, 0, 1)

    def _surface(self, parameters: Floats, moves: Controls) -> PatchSurface:
        return PatchSurface.at(self._patch.edges, self._patch.normal, parameters, moves)

    def _moves(self, controls: ArrayLike | None) -> Controls:
        return self._patch.displacements if controls is None else self._checked(controls) - self.rest
