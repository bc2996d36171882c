"""A part from CAD: solids bounded by trimmed parametric surfaces."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.cad.geometry import Map
from pliant.cad.joins import kinks
from pliant.cad.kernel import kernel, parts_of
from pliant.cad.labels import Label
from pliant.cad.rebuilding import rebuilt
from pliant.deformer import SpaceDeformer
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import PolygonMesh
from pliant.numerics.ragged import Ragged
from pliant.scene.stack import Stack

_SMOOTH = 1e-5  # radians: faces that meet at less meet smoothly
_ROUNDS = 6


@dataclass(frozen=True, eq=False, repr=False)
class Part:
    """A boundary representation. Immutable.

    Parameters
    ----------
    shape
        Open CASCADE's ``TopoDS_Shape``; lengths are millimetres.
    labels
        What is said of shapes in it: names, colours, layers, which compounds are assemblies. A deformation keeps them.
    unkept
        What the file that it was read from says beside that, one sentence each.
    """

    shape: Any
    labels: tuple[Label, ...] = ()
    unkept: tuple[str, ...] = ()

    def deformed(self, deformer: SpaceDeformer | Stack, *, tolerance: float | None = None, angle: float = 1e-3) -> Part:
        """The part after a deformation: its faces are B-spline surfaces that share their edges as before.

        Parameters
        ----------
        deformer
            A map of space, or a stack of them; in millimetres.
        tolerance
            How far new surfaces and edges may be from the exact images; knots are added until they are not. A length;
            None = a hundred-thousandth of the diagonal.
        angle
            How far from G¹ faces may meet that met smoothly, in radians; where they do not, the tolerance is lowered
            until they do. The least that is asked for is 1e-5.

        Raises
        ------
        InvalidTarget
            The deformer is no map of space.
        InvalidParameter
            A tolerance that is not positive, an angle below 1e-5.
        NotConverged
            Hundreds of spans do not meet the tolerance, faces that met smoothly do not, or the result is no valid
            solid: the deformation may fold.
        """
        if not isinstance(deformer, SpaceDeformer | Stack):
            raise InvalidTarget(f"a {type(deformer).__name__} is no map of space: it cannot deform a part")
        allowed = 1e-5 * self.mesh().diagonal if tolerance is None else float(tolerance)
        if not 0 < allowed < np.inf:
            raise InvalidParameter(f"the tolerance is {tolerance}; it must be a positive length")
        if not _SMOOTH <= angle < np.inf:
            raise InvalidParameter(f"the angle is {angle}; it must be {_SMOOTH:g} or more, in radians")
        found = self._smoothly(lambda points: np.asarray(deformer(points)), allowed, angle)
        if self.volume > 0 > found.volume:
            found = replace(found, shape=found.shape.Reversed())  # a mirror turned it inside out
        if self.valid and not found.valid:
            raise NotConverged("the deformed part is no valid solid: lower the tolerance, or see whether the map folds")
        return found

    def _smoothly(self, move: Map, tolerance: float, angle: float) -> Part:
        """The part deformed ever more exactly, until faces that met smoothly do."""
        smooth = self.kinks <= _SMOOTH
        for _ in range(_ROUNDS):
            found = replace(self, shape=rebuilt(self.shape, move, tolerance))
            if found.kinks[smooth].max(initial=0.0) <= angle:
                return found
            tolerance /= 4
        raise NotConverged(
            f"faces that met smoothly meet at {found.kinks[smooth].max():.3g} radians; {angle:.3g} is wanted: allow "
            "more, or deform more smoothly"
        )

    def mesh(self, deviation: float = 1e-3) -> PolygonMesh:
        """Its surface as triangles, closed where the part is.

        Parameters
        ----------
        deviation
            How far triangles may be from the surface, as part of the diagonal.

        Raises
        ------
        InvalidTarget
            The part has no faces.
        """
        box = kernel("Bnd").Bnd_Box()
        kernel("BRepBndLib").BRepBndLib.Add_s(self.shape, box)
        kernel("BRepMesh").BRepMesh_IncrementalMesh(self.shape, deviation * np.sqrt(box.SquareExtent()), False, 0.3)
        points: list[NDArray[np.float64]] = []
        faces = []
        for face in parts_of(self.shape, "face"):
            some, triangles = _triangles(face)
            faces.append(triangles + sum(map(len, points)))
            points.append(some)
        if not points:
            raise InvalidTarget("the part has no faces")
        places, vertex = np.unique(np.concatenate(points), axis=0, return_inverse=True)  # faces share what edges hold
        corners = vertex.reshape(-1)[np.concatenate(faces)].astype(np.int32)
        return PolygonMesh(places, Ragged.of(corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]))

    @cached_property
    def volume(self) -> float:
        """In cubic millimetres."""
        found = kernel("GProp").GProp_GProps()
        kernel("BRepGProp").BRepGProp.VolumeProperties_s(self.shape, found)
        return float(found.Mass())

    @cached_property
    def valid(self) -> bool:
        """Whether the kernel finds no fault: closed, oriented, edges on their faces."""
        return bool(kernel("BRepCheck").BRepCheck_Analyzer(self.shape).IsValid())

    @cached_property
    def gap(self) -> float:
        """The largest distance between an edge and the faces that it bounds."""
        tool = kernel("BRep").BRep_Tool
        return max((float(tool.Tolerance_s(edge)) for edge in parts_of(self.shape, "edge")), default=0.0)

    @cached_property
    def kinks(self) -> NDArray[np.float64]:
        """(e,) for each edge the largest angle between the normals of its two faces, in radians; 0 = smooth, G¹."""
        return kinks(self.shape)

    def __repr__(self) -> str:
        counts = (len(parts_of(self.shape, kind)) for kind in ("solid", "face", "edge"))
        return "Part({} solids, {} faces, {} edges)".format(*counts)


def _triangles(face: Any) -> tuple[Any, Any]:
    """The triangulation of a face, outwards: (n, 3) points and (t, 3) corners."""
    place = kernel("TopLoc").TopLoc_Location()
    found = kernel("BRep").BRep_Tool.Triangulation_s(face, place)
    if found is None:
        return np.empty((0, 3)), np.empty((0, 3), np.int32)
    nodes = [found.Node(i + 1).Transformed(place.Transformation()) for i in range(found.NbNodes())]
    corners = np.array([found.Triangle(i + 1).Get() for i in range(found.NbTriangles())], np.int32) - 1
    turned = face.Orientation() == kernel("TopAbs").TopAbs_REVERSED
    return np.array([(p.X(), p.Y(), p.Z()) for p in nodes]), corners[:, ::-1] if turned else corners
