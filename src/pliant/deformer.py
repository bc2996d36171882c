"""The central idea: bind many points to few controls once, then move the few as often as you like.

A :class:`Deformer` is a complete description of a deformation: its structure, and where its controls are. Binding
it to a target does the work that depends on structure and target only; the :class:`Binding` then answers every
move of the controls.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import LinearOperator

from pliant.errors import InvalidControls, InvalidTarget, NonFiniteResult
from pliant.mesh import CornerValues, Points, PolygonMesh, as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.maps.newton import Solution, solve
from pliant.numerics.maps.normals import carry_normals

Controls = NDArray[np.float64]
Target = PolygonMesh | ArrayLike


class Deformer(ABC):
    """A deformation: structure and controls.

    ``controls`` is what the user moves: positions ``(..., 3)``, or parameters or coefficients ``(p,)``. Deformers
    are immutable; :meth:`moved` gives the same structure with other controls.
    """

    @property
    @abstractmethod
    def rest(self) -> Controls:
        """The controls at which the deformer rests."""

    @property
    @abstractmethod
    def controls(self) -> Controls:
        """Where the controls are now, shaped as :attr:`rest`."""

    @abstractmethod
    def moved(self, controls: ArrayLike) -> Self:
        """The same structure with other controls, shaped as :attr:`rest`."""

    @abstractmethod
    def bind(self, target: Target) -> Binding:
        """Do the work that depends on structure and target only.

        Parameters
        ----------
        target
            A mesh, or (n, 3) points where the deformer allows it.
        """

    @overload
    def __call__(self, target: PolygonMesh) -> PolygonMesh: ...
    @overload
    def __call__(self, target: ArrayLike) -> Points: ...
    def __call__(self, target: Target) -> PolygonMesh | Points:
        """Deform: mesh in, mesh out; (n, 3) points in, (n, 3) points out."""
        points = self._deformed(target)
        if not isinstance(target, PolygonMesh):
            return points
        return target.with_points(points, normals=self._normals(target, points))

    def _deformed(self, target: Target) -> Points:
        """(n, 3) the deformed points, for one use: nothing need be kept."""
        return self.bind(target).deform()

    def _normals(self, mesh: PolygonMesh, points: Points) -> Points | CornerValues | None:
        """The normals that the mesh stores, after the deformation; None where it stores none."""
        return None


class SpaceDeformer(Deformer):
    """A deformation of all of R^3, whatever the shape is made of."""

    @abstractmethod
    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) the derivative of the map at (n, 3) points: row = coordinate of the image."""

    def inverse(self, points: ArrayLike, *, tolerance: float = 1e-10, iterations: int = 50) -> Points:
        """Where (n, 3) points came from.

        Parameters
        ----------
        points
            (n, 3) images.
        tolerance
            Largest residual that counts as solved, relative to the diagonal of the points and their pre-images.
        iterations
            Newton steps before giving up.

        Raises
        ------
        NotConverged
            Some points have no pre-image that Newton's method finds, or lie where the map folds; they are
            counted and the first is named.
        """
        return self._solved(as_points(points), tolerance, iterations).required()

    def _solved(self, images: Points, tolerance: float, iterations: int) -> Solution:
        """What :meth:`inverse` finds, whether or not it converged."""
        return solve(self._deformed, self.jacobian, images, tolerance=tolerance, iterations=iterations)

    def _normals(self, mesh: PolygonMesh, points: Points) -> Points | CornerValues | None:
        stored = mesh.vertex_attributes.get("normals")
        if mesh.normals is None and stored is None:
            return None
        jacobian = self.jacobian(mesh.points)
        if mesh.normals is None:
            return carry_normals(jacobian, np.asarray(stored, np.float64))
        return carry_corners(jacobian, mesh.normals, mesh.faces.flat)


class MeshDeformer(Deformer):
    """A deformation of a mesh through its own geometry. Where its controls rest, only its bindings know."""

    @property
    def rest(self) -> Controls:
        """Not known without a mesh: ask a binding."""
        raise InvalidTarget(f"a {type(self).__name__} rests where its mesh does: bind it, and ask the binding for rest")


class Binding(ABC):
    """A deformer bound to a target. Immutable, thread-safe, and it pickles."""

    _points: Points
    _controls: Controls

    @property
    @abstractmethod
    def rest(self) -> Controls:
        """The rest controls."""

    @property
    def controls(self) -> Controls:
        """The controls that the deformer had when it was bound."""
        return self._controls

    @property
    def points(self) -> Points:
        """(n, 3) the target's points, read-only."""
        return self._points

    @abstractmethod
    def deform(self, controls: ArrayLike | None = None, out: Points | None = None) -> Points:
        """The deformed points.

        Parameters
        ----------
        controls
            Shaped as :attr:`rest`; None = the deformer's own.
        out
            (n, 3) float64, C order, to be overwritten and returned.

        Returns
        -------
        ndarray
            (n, 3), never an alias of the binding's own arrays.

        Raises
        ------
        InvalidControls
            Another shape than :attr:`rest`, or values that are not finite.
        """

    def drag(self, controls: ArrayLike | None = None) -> Drag:
        """Begin an interaction at some controls: an object that owns its buffer and updates it in place."""
        return Drag(self, controls)

    @abstractmethod
    def jvp(self, controls: ArrayLike | None, d_controls: ArrayLike) -> Points:
        """(n, 3) how the deformed points change when the controls change by ``d_controls``."""

    @abstractmethod
    def vjp(self, controls: ArrayLike | None, d_points: ArrayLike) -> Controls:
        """The transpose of :meth:`jvp`: pulls (n, 3) gradients back to the controls."""

    def _checked(self, controls: ArrayLike | None) -> Controls:
        """Controls as a finite float64 array shaped as :attr:`rest`."""
        return self.controls if controls is None else checked_controls(controls, self.rest.shape)


class LinearBinding(Binding):
    """A binding whose points are linear in the controls: x' = b + W (c - c_rest), with b = deform(rest)."""

    @property
    def weights(self) -> LinearOperator:
        """W as an operator: (n, m) for m control points, each coordinate alike; (3n, p) for p coefficients."""
        return LinearOperator(
            (self.points.size, self.rest.size),
            dtype=np.float64,
            matvec=lambda change: self.jvp(None, np.reshape(change, self.rest.shape)).reshape(-1),
            rmatvec=lambda gradient: self.vjp(None, np.reshape(gradient, self.points.shape)).reshape(-1),
        )


class Drag:
    """An interaction: owns a buffer of deformed points and keeps it up to date while controls move.

    This form re-evaluates everything; bindings with local support return a faster one.
    """

    def __init__(self, binding: Binding, controls: ArrayLike | None = None) -> None:
        self._binding = binding
        self._controls = binding._checked(controls).copy()
        self._buffer = binding.deform(self._controls)

    @property
    def points(self) -> Points:
        """(n, 3) the deformed points now: a read-only view of the buffer."""
        view = self._buffer.view()
        view.flags.writeable = False
        return view

    def update(self, controls: ArrayLike, changed: Any = None) -> NDArray[np.integer]:
        """Move the controls.

        Parameters
        ----------
        controls
            All controls, shaped as rest.
        changed
            Indices of the controls that differ from the last call, as index tuples into the controls' leading
            axes; None = find out.

        Returns
        -------
        ndarray
            (k,) indices of the points that were recomputed.
        """
        new = self._binding._checked(controls)
        before = self._buffer.copy()
        self._binding.deform(new, out=self._buffer)
        self._controls = new.copy()
        return np.flatnonzero((before != self._buffer).any(axis=1))


def checked_controls(controls: ArrayLike, shape: tuple[int, ...]) -> Controls:
    """Controls as a finite, C-ordered float64 array of a shape.

    Raises
    ------
    InvalidControls
        No numbers, another shape, or values that are not finite.
    """
    array = np.ascontiguousarray(as_numbers("controls", controls, InvalidControls))
    if array.shape != shape:
        raise InvalidControls(f"controls have shape {array.shape}; this deformer's have {shape}")
    if not np.isfinite(array).all():
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise InvalidControls(f"control {first} is {array[first]}; controls must be finite")
    return array


def checked_out(out: Points | None, count: int) -> Points:
    """A buffer for (count, 3) results: the caller's, if it fits, or a new one.

    Raises
    ------
    InvalidTarget
        Another shape, type or order, or a buffer that is read-only.
    """
    if out is None:
        return np.empty((count, 3))
    if out.shape != (count, 3) or out.dtype != np.float64 or not out.flags.c_contiguous or not out.flags.writeable:
        raise InvalidTarget(f"out must be a writable C-ordered float64 array of shape {(count, 3)}")
    return out


def require_finite(points: Points, what: str) -> Points:
    """The points, if all are finite.

    Raises
    ------
    NonFiniteResult
        With the count and the first index of those that are not.
    """
    if not np.isfinite(points).all():
        bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
        raise NonFiniteResult(f"{what}: {len(bad)} of {len(points):,} points are not finite, first point {bad[0]}")
    return points


def carry_corners(jacobian: NDArray[np.float64], normals: CornerValues, vertices: NDArray[np.int32]) -> CornerValues:
    """Corner normals after a deformation; the pool keeps its layout where each entry has one image."""
    used = np.flatnonzero(normals.indices >= 0)
    pairs = np.stack([normals.indices[used], vertices[used]], axis=1)
    unique, inverse = np.unique(pairs, axis=0, return_inverse=True)
    carried = carry_normals(jacobian[unique[:, 1]], normals.values[unique[:, 0]])
    if len(np.unique(unique[:, 0])) == len(unique):
        values = normals.values.copy()
        values[unique[:, 0]] = carried
        return CornerValues(values, normals.indices)
    indices = np.full(len(normals.indices), -1, np.int32)
    indices[used] = inverse.reshape(-1)
    return CornerValues(carried, indices)
