"""Curves and surfaces of a part, evaluated, deformed, and made anew as B-splines on the same parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.cad.fitting import DEGREE, Knots, refined
from pliant.cad.kernel import kernel
from pliant.mesh import Points

Floats = NDArray[np.float64]
Map = Callable[[Points], Points]
_LINES = 13  # of a surface, along which knots are sought
_SHARE = 0.4  # of the tolerance, for each direction


def deformed_curve(curve: Any, first: float, last: float, move: Map, tolerance: float) -> Any:
    """The image of a curve between two parameters, as a B-spline within a tolerance."""
    adaptor = kernel("GeomAdaptor").GeomAdaptor_Curve(curve, first, last)
    knots = _knots(adaptor.NbIntervals, adaptor.Intervals, first, last)

    def images(at: Floats) -> Floats:
        return move(np.array([_place(curve.Value(t)) for t in at]))[:, None]

    knots = refined(images, knots, tolerance)
    poles = knots.coefficients(images(knots.sites))[:, 0]
    collections = kernel("collections")
    array = collections.Array1_gp_Pnt(1, len(poles))
    for i, pole in enumerate(poles):
        array.SetValue(i + 1, kernel("gp").gp_Pnt(*pole))
    return kernel("Geom").Geom_BSplineCurve(array, *_arrays(knots), DEGREE)


def deformed_surface(surface: Any, bounds: tuple[float, float, float, float], move: Map, tolerance: float) -> Any:
    """The image of a surface over a rectangle of parameters, as a B-spline within a tolerance.

    Knots are sought in each direction along several lines of the other. The parameters stay, so that curves which trim
    the surface do, too.
    """
    u0, u1, v0, v1 = bounds
    adaptor = kernel("GeomAdaptor").GeomAdaptor_Surface(surface, u0, u1, v0, v1)
    u = _knots(adaptor.NbUIntervals, adaptor.UIntervals, u0, u1)
    v = _knots(adaptor.NbVIntervals, adaptor.VIntervals, v0, v1)

    def images(us: Floats, vs: Floats) -> Floats:
        points = np.array([_place(surface.Value(a, b)) for a in us for b in vs])
        return move(points).reshape(len(us), len(vs), 3)

    across, along = np.linspace(v0, v1, _LINES), np.linspace(u0, u1, _LINES)
    u = refined(lambda at: images(at, across), u, _SHARE * tolerance)
    v = refined(lambda at: images(along, at).swapaxes(0, 1), v, _SHARE * tolerance)
    values = u.coefficients(images(u.sites, v.sites))
    poles = v.coefficients(values.swapaxes(0, 1)).swapaxes(0, 1)
    array = kernel("collections").Array2_gp_Pnt(1, len(poles), 1, poles.shape[1])
    for i, row in enumerate(poles):
        for j, pole in enumerate(row):
            array.SetValue(i + 1, j + 1, kernel("gp").gp_Pnt(*pole))
    (uk, um), (vk, vm) = _arrays(u), _arrays(v)
    return kernel("Geom").Geom_BSplineSurface(array, uk, vk, um, vm, DEGREE, DEGREE)


def moved_point(point: Any, move: Map) -> Any:
    """The image of a point."""
    return kernel("gp").gp_Pnt(*move(np.array([_place(point)]))[0])


def _place(point: Any) -> tuple[float, float, float]:
    return point.X(), point.Y(), point.Z()


def _knots(count: Callable[[Any], int], fill: Callable[[Any, Any], None], first: float, last: float) -> Knots:
    """Breaks where a curve or surface is not C², as smooth there as it is, and a few in between."""
    kinds, array = kernel("GeomAbs"), kernel("collections").Array1_double
    smooth: dict[float, int] = {}
    for order, kind in ((2, kinds.GeomAbs_C2), (3, kinds.GeomAbs_C1)):
        number = count(kind)
        places = array(1, number + 1)
        fill(places, kind)
        smooth.update({places.Value(i): order for i in range(2, number + 1)})
    inner = {at: order for at, order in smooth.items() if first < at < last}
    breaks = np.unique([first, *inner, last])
    counts = np.array([inner.get(float(at), 4) for at in breaks], np.int32)
    knots = Knots(breaks, counts)
    return knots.split(np.ones(len(breaks) - 1, bool))


def _arrays(knots: Knots) -> tuple[Any, Any]:
    """Breaks and multiplicities, as the kernel wants them."""
    collections, count = kernel("collections"), len(knots.breaks)
    breaks, multiplicities = collections.Array1_double(1, count), collections.Array1_int(1, count)
    for i in range(count):
        breaks.SetValue(i + 1, float(knots.breaks[i]))
        multiplicities.SetValue(i + 1, int(knots.multiplicities[i]))
    return breaks, multiplicities
