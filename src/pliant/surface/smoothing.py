"""Smoothing: four ways to take the roughness off a mesh."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array, diags_array

from pliant.deformer import require_finite
from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.given import as_count, as_number
from pliant.numerics.meshes.laplacians import WEIGHTS, laplacian, masses, normalized
from pliant.numerics.ragged import Ragged
from pliant.numerics.sparse.sparse_cholesky import Cholesky
from pliant.surface.constraints import indices_in, mesh_of, vertex_set
from pliant.surface.editing import spread_to
from pliant.surface.shading import shading_normals

Method = Literal["implicit", "explicit", "taubin", "delta mush"]
METHODS = ("implicit", "explicit", "taubin", "delta mush")

_PASS_BAND = 0.1  # Taubin: frequencies below this part of the highest pass


def smooth(
    mesh: PolygonMesh,
    iterations: int = 5,
    *,
    method: Method = "implicit",
    strength: float = 0.5,
    weights: str | None = None,
    rest: PolygonMesh | None = None,
    within: ArrayLike | None = None,
) -> PolygonMesh:
    """Smooth a mesh.

    ``"implicit"`` is backward Euler for the mean curvature flow (Desbrun et al. 1999): stable at any strength.
    ``"explicit"`` moves each vertex towards its neighbours' mean. ``"taubin"`` (1995) alternates that with a step
    outwards, so that the volume is kept. ``"delta mush"`` (Mancewicz et al. 2014) is for a mesh that was posed roughly:
    what smoothing takes off ``rest`` is put back on the smoothed pose.

    Parameters
    ----------
    mesh
        Any mesh with faces. Edges that bound one face only are smoothed too; a vertex without a face stays.
    method
        One of the four.
    iterations
        How often; 0 changes nothing.
    strength
        Explicit and Taubin: the part of the way to the neighbours' mean, in (0, 1]. Implicit and delta mush: the
        same, of a flow that lasts as long.
    weights
        ``"cotangent"``, ``"intrinsic"``, ``"uniform"`` or (explicit and Taubin only) ``"mean value"``; None =
        cotangent, or uniform for explicit and Taubin.
    rest
        For delta mush: the mesh before it was posed.
    within
        Vertices that may move, indices or a mask; None = all. The others stay, bit by bit.

    Returns
    -------
    PolygonMesh
        The same mesh with other points; stored normals are computed anew.

    Raises
    ------
    InvalidParameter
        An unknown method, a strength or a number of iterations that makes no sense, or a rest that does not match.
    """
    mesh = mesh_of(mesh, "smoothing")
    _check(iterations, method, strength, weights, mesh, rest)
    moving = _moving(mesh, within)
    kind = weights or ("uniform" if method in ("explicit", "taubin") else "cotangent")
    if method == "implicit":
        points = _flow(mesh, mesh.points, kind, iterations, strength, moving)
    elif method == "delta mush":
        assert rest is not None
        points = _mushed(mesh, rest, kind, iterations, strength, moving)
    else:
        steps = [strength] if method == "explicit" else [strength, -strength / (1 - _PASS_BAND * strength)]
        operator = normalized(WEIGHTS[kind](mesh.points, mesh.triangles))[moving]
        points = mesh.points.copy()
        for _ in range(iterations):
            for step in steps:
                points[moving] -= step * (operator @ points)
    require_finite(points, "smoothing")
    return mesh.with_points(points, normals=shading_normals(mesh, points))


def _flow(
    mesh: PolygonMesh, points: Points, kind: str, iterations: int, strength: float, moving: NDArray[np.int64]
) -> Points:
    """(M + τ L) x' = M x, with weights and areas of the mesh as it was: factored once."""
    weights, mass = WEIGHTS[kind](mesh.points, mesh.triangles), masses(mesh.points, mesh.triangles)
    stiffness = laplacian(weights)
    typical = float(np.median(stiffness.diagonal()[moving] / mass[moving])) if len(moving) else 1.0
    system = csr_array(diags_array(mass) + strength / (typical or 1.0) * stiffness)[moving]
    factor = Cholesky(csc_array(system[:, moving]))
    result = points.copy()
    for _ in range(iterations):
        right = mass[moving, None] * result[moving] - system @ result
        result[moving] += factor.solve(np.asarray(right))
    return result


def _mushed(
    mesh: PolygonMesh, rest: PolygonMesh, kind: str, iterations: int, strength: float, moving: NDArray[np.int64]
) -> Points:
    """The smoothed pose, with the differences between the rest and its smoothed self, in local frames."""
    still = _flow(rest, rest.points, kind, iterations, strength, moving)
    posed = _flow(rest, mesh.points, kind, iterations, strength, moving)
    chosen = mesh.triangles
    delta = np.einsum("nji,nj->ni", _frames(still, chosen), rest.points - still)
    offsets = np.einsum("nij,nj->ni", _frames(posed, chosen), delta)
    return np.asarray(mesh.points + spread_to(len(posed), moving, (posed + offsets - mesh.points)[moving]))


def _frames(points: Points, triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """(n, 3, 3) columns: a tangent, its normal's cross product with it, and the normal at each vertex."""
    normals = PolygonMesh(points, Ragged.of(triangles)).vertex_normals
    towards = np.zeros_like(points)
    first = np.unique(triangles.reshape(-1), return_index=True)
    towards[first[0]] = points[np.roll(triangles, -1, axis=1).reshape(-1)[first[1]]] - points[first[0]]
    across = np.cross(normals, towards)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    return np.stack([np.cross(across, normals), across, normals], axis=2)


def _moving(mesh: PolygonMesh, within: ArrayLike | None) -> NDArray[np.int64]:
    used = np.zeros(len(mesh.points), bool)
    used[mesh.triangles] = True
    if within is not None:
        chosen = np.zeros(len(mesh.points), bool)
        chosen[indices_in(mesh, vertex_set(within, "within"), "within")] = True
        used &= chosen
    return np.flatnonzero(used)


def _check(
    iterations: int, method: str, strength: float, weights: str | None, mesh: PolygonMesh, rest: PolygonMesh | None
) -> None:
    if method not in METHODS:
        raise InvalidParameter(f"no method is called {method!r}; there are: {', '.join(METHODS)}")
    as_count("iterations", iterations, InvalidParameter)
    if as_number("strength", strength, InvalidParameter) <= 0:
        raise InvalidParameter(f"strength is {strength}; a positive number is needed")
    steps = method in ("explicit", "taubin")
    if steps and strength > 1:
        raise InvalidParameter(f"strength is {strength}; above 1 {method!r} is not stable: use 'implicit'")
    known = [name for name in WEIGHTS if steps or name != "mean value"]
    if weights is not None and weights not in known:
        raise InvalidParameter(f"{method!r} knows no weights {weights!r}; it knows: {', '.join(known)}")
    if (method == "delta mush") != (rest is not None):
        raise InvalidParameter("delta mush, and only that, needs rest: the mesh before it was posed")
    if rest is not None and (
        len(rest.points) != len(mesh.points) or not np.array_equal(rest.triangles, mesh.triangles)
    ):
        raise InvalidParameter("rest is another mesh: its vertices or faces differ from the posed one's")
