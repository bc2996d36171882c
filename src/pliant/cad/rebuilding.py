"""A part with every face, edge and vertex in its new place: the same topology on other geometry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pliant.cad.geometry import Map, deformed_curve, deformed_surface, moved_point
from pliant.cad.kernel import kernel, parts_of, settled


@dataclass(frozen=True, eq=False)
class _Trim:
    """The curves, one or two along a seam, by which an edge trims a face, and their range."""

    edge: Any
    curves: tuple[Any, ...]
    ends: tuple[float, float]


def rebuilt(shape: Any, move: Map, tolerance: float) -> Any:
    """A shape deformed.

    Surfaces and edges become B-splines on the parameters that they had; curves in the parameter planes stay. Faces
    share their edges as before; how far an edge lies from its faces becomes its tolerance.
    """
    whole = _own(shape)
    build, nowhere = kernel("BRep").BRep_Builder(), kernel("TopLoc").TopLoc_Location()
    tool, edges = kernel("BRep").BRep_Tool, parts_of(whole, "edge")
    for face in parts_of(whole, "face"):
        trims = [_trim(edge, face) for edge in parts_of(face, "edge")]
        bounds = kernel("BRepTools").BRepTools.UVBounds_s(face)
        surface = deformed_surface(tool.Surface_s(face), bounds, move, tolerance)
        for trim in trims:
            kernel("ShapeBuild").ShapeBuild_Edge().RemovePCurve(trim.edge, face)
        build.UpdateFace(face, surface, nowhere, tolerance)
        build.NaturalRestriction(face, False)
        for trim in trims:
            build.UpdateEdge(trim.edge, *trim.curves, surface, nowhere, tolerance)
            build.Range(trim.edge, surface, nowhere, *trim.ends)
    for edge in edges:
        if not tool.Degenerated_s(edge):
            first, last = tool.Range_s(edge)
            curve = deformed_curve(tool.Curve_s(edge, 0.0, 1.0), first, last, move, tolerance)
            build.UpdateEdge(edge, curve, nowhere, tolerance)
            build.Range(edge, first, last, True)
        build.SameParameter(edge, tool.Degenerated_s(edge))
    for vertex in parts_of(whole, "vertex"):
        build.UpdateVertex(vertex, moved_point(tool.Pnt_s(vertex), move), tolerance)
    kernel("BRepLib").BRepLib.SameParameter_s(whole, tolerance, True)
    kernel("BRepLib").BRepLib.UpdateTolerances_s(whole)
    return whole


def _own(shape: Any) -> Any:
    """A copy that shares nothing, each part where it is without being told."""
    copy = kernel("BRepBuilderAPI").BRepBuilderAPI_Copy(shape).Shape()
    found = settled(copy)
    kernel("BRepLib").BRepLib.BuildCurves3d_s(found)
    kernel("BRepTools").BRepTools.Clean_s(found)
    return found


def _trim(edge: Any, face: Any) -> _Trim:
    tool = kernel("BRep").BRep_Tool
    forward = kernel("TopoDS").TopoDS.Edge(edge.Oriented(kernel("TopAbs").TopAbs_FORWARD))
    plain = kernel("TopoDS").TopoDS.Face(face.Oriented(kernel("TopAbs").TopAbs_FORWARD))
    curves = [tool.CurveOnSurface_s(forward, plain, 0.0, 1.0)]
    if tool.IsClosed_s(forward, plain):
        other = kernel("TopoDS").TopoDS.Edge(edge.Oriented(kernel("TopAbs").TopAbs_REVERSED))
        curves.append(tool.CurveOnSurface_s(other, plain, 0.0, 1.0))
    return _Trim(forward, tuple(curves), tool.Range_s(forward, plain))
