"""Trees of solids: leaves are meshes, nodes are booleans and deformations; a mesh is made when it is asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from pliant.deformer import Deformer
from pliant.errors import InvalidParameter
from pliant.field.volumes import volume
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.shapes.manifolds import Names, import_manifold, manifold_of, mesh_of
from pliant.space.affine import Affine

Operation = Literal["union", "intersection", "difference"]
Deforming = Deformer | Callable[[PolygonMesh], Deformer]
_PIECES = 48  # that a diagonal is cut into before a deformation, if nothing is said


class Solid(ABC):
    """A closed shape, made of others.

    ``a | b`` is their union, ``a & b`` what they have in common, ``a - b`` the first without the second. Any solid can
    be deformed, and be a part of others then: a deformation is a modelling operator like the booleans (Barr 1984,
    section 1).
    """

    @property
    @abstractmethod
    def mesh(self) -> PolygonMesh:
        """Its closed surface, faces outwards; its groups say which leaf each face came from."""

    def __or__(self, other: Solid) -> Solid:
        return _joined("union", self, other)

    def __and__(self, other: Solid) -> Solid:
        return _joined("intersection", self, other)

    def __sub__(self, other: Solid) -> Solid:
        return _joined("difference", self, other)

    def deformed(self, deformer: Deforming, *, edge: float | None = None) -> Solid:
        """The solid after a deformation.

        Parameters
        ----------
        deformer
            Any deformer or stack; or a function that makes one for the solid's mesh, such as
            ``lambda mesh: pl.Twist.around(mesh, axis="z", angle=1.0)``.
        edge
            Edges that are longer are cut before, so that flat faces can bend; a length. None = the 48th part of the
            diagonal; ``inf`` = none are cut.

        Raises
        ------
        InvalidParameter
            No deformer, or an edge that is not positive.
        """
        if not isinstance(deformer, Deformer) and not callable(deformer):
            raise InvalidParameter(f"a solid is deformed by a deformer, not by a {type(deformer).__name__}")
        if edge is not None and not edge > 0:
            raise InvalidParameter(f"edge is {edge}; it must be a positive length")
        return Deformed(self, deformer, edge)

    def moved(self, offset: ArrayLike) -> Solid:
        """The solid elsewhere, by an offset (3,)."""
        return Deformed(self, Affine.translation(offset), np.inf)

    def turned(self, axis: Any, angle: float, about: ArrayLike = (0.0, 0.0, 0.0)) -> Solid:
        """The solid turned about an axis through a place (3,), by radians."""
        return Deformed(self, Affine.rotation(axis, angle, about), np.inf)

    def scaled(self, factors: Any, about: ArrayLike = (0.0, 0.0, 0.0)) -> Solid:
        """The solid scaled about a place (3,), by one factor or (3,); negative ones mirror it."""
        return Deformed(self, Affine.scaling(factors, about), np.inf)

    @property
    def volume(self) -> float:
        """Of its mesh; zero where nothing is left."""
        return volume(self.mesh) if len(self.mesh.faces) else 0.0

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self.mesh.points):,} points, {len(self.mesh.faces):,} faces)"


@dataclass(frozen=True, eq=False, repr=False)
class Leaf(Solid):
    """A closed mesh.

    Parameters
    ----------
    surface
        The mesh.
    """

    surface: PolygonMesh

    @property
    def mesh(self) -> PolygonMesh:
        return self.surface


@dataclass(frozen=True, eq=False, repr=False)
class Boolean(Solid):
    """Solids joined by an operation, the first with all others.

    Parameters
    ----------
    operation
        ``"union"``, ``"intersection"`` or ``"difference"``.
    parts
        The solids.
    """

    operation: Operation
    parts: tuple[Solid, ...]

    @cached_property
    def mesh(self) -> PolygonMesh:
        library, names = import_manifold(), Names()
        ways = {
            "union": library.OpType.Add,
            "intersection": library.OpType.Intersect,
            "difference": library.OpType.Subtract,
        }
        parts = [manifold_of(part.mesh, names) for part in self.parts]
        return mesh_of(library.Manifold.batch_boolean(parts, ways[self.operation]), names)


@dataclass(frozen=True, eq=False, repr=False)
class Deformed(Solid):
    """A solid after a deformation.

    Parameters
    ----------
    part
        The solid.
    deformer, edge
        As for :meth:`Solid.deformed`.
    """

    part: Solid
    deformer: Deforming
    edge: float | None = None

    @cached_property
    def mesh(self) -> PolygonMesh:
        mesh = self.part.mesh
        if not len(mesh.points):
            return mesh
        mesh = _cut(mesh, mesh.diagonal / _PIECES if self.edge is None else self.edge)
        deformer = self.deformer if isinstance(self.deformer, Deformer) else self.deformer(mesh)
        if not isinstance(deformer, Deformer):
            raise InvalidParameter(f"the function has made a {type(deformer).__name__}, no deformer")
        moved = deformer(mesh)
        return moved if volume(moved) >= 0 else _turned(moved)


def _joined(operation: Operation, one: Solid, two: Any) -> Solid:
    """Two solids joined; a chain of the same operation is one node."""
    if not isinstance(two, Solid):
        raise InvalidParameter(
            f"solids are joined to solids, not to a {type(two).__name__}: wrap a closed mesh by pl.shapes.solid"
        )
    if isinstance(one, Boolean) and one.operation == operation:
        return Boolean(operation, (*one.parts, two))
    return Boolean(operation, (one, two))


def _cut(mesh: PolygonMesh, edge: float) -> PolygonMesh:
    """The mesh with no edge longer than a length; as it is, if none is."""
    ends = mesh.points[mesh.edges]
    if not np.isfinite(edge) or (np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) <= edge).all():
        return mesh
    names = Names()
    return mesh_of(manifold_of(mesh, names).refine_to_length(edge), names)


def _turned(mesh: PolygonMesh) -> PolygonMesh:
    """The mesh with all faces turned round: a mirror has turned them before."""
    return mesh.replace(faces=Ragged.of([mesh.faces[i][::-1] for i in range(len(mesh.faces))]))
