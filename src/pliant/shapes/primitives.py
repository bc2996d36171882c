"""Primitives: the leaves of trees. Vertices lie on the true surfaces; faces are quadrangles where there is a choice."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.attributes import FaceLabels
from pliant.errors import InvalidMesh, InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_numbers
from pliant.shapes.grids import cube_sphere, lathe, ring_of_rings
from pliant.shapes.tree import Leaf, Solid

_MOST = 4096
_LEAST_EXPONENT, _MOST_EXPONENT = 0.05, 4.0


def box(size: Any = (1.0, 1.0, 1.0), center: ArrayLike = (0.0, 0.0, 0.0), *, name: str = "box") -> Solid:
    """A box, of six quadrangles.

    Parameters
    ----------
    size
        Its three extents, or one for a cube.
    center
        (3,) its middle.
    name
        What its faces are called in the groups of a mesh that it becomes a part of.

    Raises
    ------
    InvalidParameter
        Lengths that are not positive, or a center that is no three finite numbers.
    """
    extents = _lengths("size", size, 3)
    signs = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float64)
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return _leaf(signs * extents / 2, faces, center, name)


def sphere(
    radius: float = 1.0, center: ArrayLike = (0.0, 0.0, 0.0), *, segments: int = 64, name: str = "sphere"
) -> Solid:
    """A sphere, as a cube blown up: no poles.

    Parameters
    ----------
    radius
        Its radius.
    center
        (3,) its middle.
    segments
        Edges around it, a multiple of four or rounded up to one.
    name
        As for :func:`box`.

    Raises
    ------
    InvalidParameter
        Lengths that are not positive, or fewer than 3 or more than 4,096 segments.
    """
    unit, faces = cube_sphere(_cells(segments))
    return _leaf(unit * _lengths("radius", radius, 1), faces, center, name)


def cylinder(
    radius: float = 1.0,
    height: float = 2.0,
    center: ArrayLike = (0.0, 0.0, 0.0),
    *,
    segments: int = 64,
    name: str = "cylinder",
) -> Solid:
    """A cylinder along z.

    Parameters
    ----------
    radius, height
        Its radius and its height.
    center
        (3,) its middle.
    segments
        Edges around it.
    name
        As for :func:`box`.

    Raises
    ------
    InvalidParameter
        As for :func:`sphere`.
    """
    r, h = _lengths("radius", radius, 1)[0], _lengths("height", height, 1)[0]
    points, faces = lathe(np.array([r, r]), np.array([-h / 2, h / 2]), _count(segments))
    return _leaf(points, faces, center, name)


def cone(
    radius: float = 1.0,
    height: float = 2.0,
    center: ArrayLike = (0.0, 0.0, 0.0),
    *,
    top: float = 0.0,
    segments: int = 64,
    name: str = "cone",
) -> Solid:
    """A cone along z, pointed upwards or cut off.

    Parameters
    ----------
    radius, height
        Of its base, and between base and top.
    center
        (3,) the middle of its axis.
    top
        The radius at the top; 0 = a point.
    segments
        Edges around it.
    name
        As for :func:`box`.

    Raises
    ------
    InvalidParameter
        As for :func:`sphere`, or a radius at the top below zero.
    """
    r, h = _lengths("radius", radius, 1)[0], _lengths("height", height, 1)[0]
    upper = as_numbers("top", top, InvalidParameter)
    if upper.shape or not 0 <= upper < np.inf:
        raise InvalidParameter(f"the top radius is {top}; it must be 0 or a length")
    points, faces = lathe(np.array([r, float(upper)]), np.array([-h / 2, h / 2]), _count(segments))
    return _leaf(points, faces, center, name)


def torus(
    radius: float = 1.0,
    tube: float = 0.25,
    center: ArrayLike = (0.0, 0.0, 0.0),
    *,
    segments: int = 96,
    name: str = "torus",
) -> Solid:
    """A torus around z.

    Parameters
    ----------
    radius
        Of the circle that the tube follows.
    tube
        Of the tube; smaller than ``radius``.
    center
        (3,) its middle.
    segments
        Edges around z; around the tube there are about as many a length.
    name
        As for :func:`box`.

    Raises
    ------
    InvalidParameter
        As for :func:`sphere`, or a tube as thick as the ring.
    """
    r, t = _lengths("radius", radius, 1)[0], _lengths("tube", tube, 1)[0]
    if t >= r:
        raise InvalidParameter(f"the tube's radius {t:g} must be smaller than the ring's {r:g}: it would cut itself")
    around = _count(segments)
    points, faces = ring_of_rings(r, t, around, max(8, round(around * t / r)))
    return _leaf(points, faces, center, name)


def superquadric(
    size: Any = (2.0, 2.0, 2.0),
    exponents: tuple[float, float] = (1.0, 1.0),
    center: ArrayLike = (0.0, 0.0, 0.0),
    *,
    segments: int = 96,
    name: str = "superquadric",
) -> Solid:
    """A superellipsoid: ((x/a)^(2/e2) + (y/b)^(2/e2))^(e2/e1) + (z/c)^(2/e1) = 1 (Barr 1981, section 2).

    Directions of a cube blown up are stretched to the surface, which holds for all exponents.

    Parameters
    ----------
    size
        Its extents 2a, 2b, 2c, or one for all.
    exponents
        North to south e1, and around e2, in [0.05, 4]: towards 0 a box, 1 an ellipsoid, 2 an octahedron, beyond 2
        hollow.
    center
        (3,) its middle.
    segments
        Edges around it, a multiple of four or rounded up to one.
    name
        As for :func:`box`.

    Raises
    ------
    InvalidParameter
        As for :func:`sphere`, or exponents outside [0.05, 4].
    """
    half = _lengths("size", size, 3) / 2
    try:
        e1, e2 = (float(each) for each in exponents)
    except (TypeError, ValueError) as error:
        raise InvalidParameter(f"exponents are two numbers, not {exponents!r}") from error
    if not (_LEAST_EXPONENT <= e1 <= _MOST_EXPONENT and _LEAST_EXPONENT <= e2 <= _MOST_EXPONENT):
        raise InvalidParameter(f"exponents are {e1:g} and {e2:g}; each lies between 0.05 and 4")
    unit, faces = cube_sphere(_cells(segments))
    x, y, z = np.abs(unit).T
    inside = (x ** (2 / e2) + y ** (2 / e2)) ** (e2 / e1) + z ** (2 / e1)
    return _leaf(unit * (inside ** (-e1 / 2))[:, None] * half, faces, center, name)


def solid(mesh: PolygonMesh, *, name: str = "solid") -> Solid:
    """A closed mesh as a solid; its own groups are kept.

    Parameters
    ----------
    mesh
        The mesh, faces outwards.
    name
        What its faces are called if it has no groups.

    Raises
    ------
    InvalidMesh
        Edges that do not bound two faces that agree.
    """
    open_edges, crowded = mesh.edge_use
    if open_edges or crowded or not len(mesh.faces):
        raise InvalidMesh(
            f"no solid: of {len(mesh.faces):,} faces {open_edges} edges bound one only, {crowded} bound three or more "
            "or disagree (close the mesh, and turn all faces outwards)"
        )
    return Leaf(mesh if mesh.groups is not None else _named(mesh, name))


def _leaf(points: Points, faces: Any, center: ArrayLike, name: str) -> Solid:
    middle = as_numbers("the center", center, InvalidParameter)
    if middle.shape != (3,) or not np.isfinite(middle).all():
        raise InvalidParameter(f"the center is {center!r}; three finite numbers are needed")
    return Leaf(_named(PolygonMesh(points + middle, faces), name))


def _named(mesh: PolygonMesh, name: str) -> PolygonMesh:
    return mesh.replace(groups=FaceLabels((name,), np.zeros(len(mesh.faces), np.int32)))


def _lengths(name: str, value: Any, count: int) -> NDArray[np.float64]:
    """(count,) positive lengths."""
    given = as_numbers(name, value, InvalidParameter)
    if given.shape not in ((), (1,), (count,)):
        raise InvalidParameter(f"{name} has shape {given.shape}; {count} positive lengths are needed")
    found = np.broadcast_to(given, (count,))
    if not (np.isfinite(found).all() and (found > 0).all()):
        raise InvalidParameter(f"{name} is {value!r}; lengths must be positive and finite")
    return found


def _count(segments: int) -> int:
    if not isinstance(segments, int | float | np.integer) or not 3 <= segments <= _MOST:
        raise InvalidParameter(f"segments is {segments!r}; it is a number between 3 and {_MOST}")
    return int(segments)


def _cells(segments: int) -> int:
    return -(-_count(segments) // 4)
