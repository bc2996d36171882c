"""Cages by alpha wrapping, through pymeshlab: tighter, and under the GPL."""

from __future__ import annotations

from typing import Any

import numpy as np

from pliant.cages.checking import check_cage
from pliant.errors import MissingExtra, NotConverged
from pliant.mesh import PolygonMesh

_HALVINGS = 12


def alpha_wrapped(mesh: PolygonMesh, vertices: int, margin: float) -> PolygonMesh:
    """The finest alpha wrap (Portaneri et al. 2022) of at most some vertices, by bisection of alpha.

    Parameters
    ----------
    mesh
        What to wrap.
    vertices
        How many vertices there may be.
    margin
        The wrap's distance, in diagonals.

    Raises
    ------
    MissingExtra
        pymeshlab is not installed.
    NotConverged
        No alpha gives a wrap within the budget.
    """
    lab = _import_lab()
    low, high, best = np.log(0.01), np.log(1.0), None
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        found = _wrap(lab, mesh, 100 * float(np.exp(middle)), 100 * margin)
        if len(found.points) <= vertices and check_cage(found, mesh, vertices=vertices).ok:
            best, high = found, middle
        else:
            low = middle
    if best is None:
        raise NotConverged(f"no alpha wrap has {vertices} vertices or fewer: allow more, or a wider margin")
    return best


def _wrap(lab: Any, mesh: PolygonMesh, alpha: float, offset: float) -> PolygonMesh:
    session = lab.MeshSet()
    session.add_mesh(lab.Mesh(mesh.points, mesh.triangles))
    session.generate_alpha_wrap(alpha=lab.PercentageValue(alpha), offset=lab.PercentageValue(offset))
    made = session.current_mesh()
    return PolygonMesh(made.vertex_matrix(), made.face_matrix())


def _import_lab() -> Any:
    try:
        import pymeshlab
    except ImportError:
        raise MissingExtra("alpha wrapping", "cages-gpl") from None
    return pymeshlab
