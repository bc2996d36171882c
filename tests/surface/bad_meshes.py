"""Meshes with what real ones have: each flaw by name, and a strategy that mixes them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from surface_shapes import sheet, tube

from pliant.mesh import PolygonMesh

FLAWS = (
    "non-manifold edge", "degenerate triangle", "repeated corner", "needle", "duplicate points", "unused vertex",
    "second component", "hole", "flipped face",
)  # fmt: skip


def flawed(mesh: PolygonMesh, flaw: str, random: np.random.Generator) -> PolygonMesh:
    points, faces = mesh.points.copy(), mesh.triangles.copy()
    at = faces[random.integers(len(faces))]
    if flaw == "non-manifold edge":
        points = np.vstack([points, points[at[0]] + random.normal(size=3)])
        faces = np.vstack([faces, [at[0], at[1], len(points) - 1]])
    elif flaw == "degenerate triangle":
        points = np.vstack([points, (points[at[0]] + points[at[1]]) / 2])
        faces = np.vstack([faces, [at[0], at[1], len(points) - 1]])
    elif flaw == "repeated corner":
        faces = np.vstack([faces, [at[0], at[1], at[1]]])
    elif flaw == "needle":
        points[at[0]] = points[at[1]] + 1e-9 * (points[at[0]] - points[at[1]])
    elif flaw == "duplicate points":
        points[at[0]] = points[at[1]]
    elif flaw == "unused vertex":
        points = np.vstack([points, random.normal(size=(2, 3))])
    elif flaw == "second component":
        other = sheet(4, 3)
        faces = np.vstack([faces, other.triangles + len(points)])
        points = np.vstack([points, other.points + [5.0, 0, 0]])
    elif flaw == "hole":
        faces = np.delete(faces, random.integers(len(faces), size=3), axis=0)
    else:
        faces[random.integers(len(faces))] = at[::-1]
    return PolygonMesh(points, faces)


@st.composite
def bad_meshes(draw) -> PolygonMesh:
    mesh = draw(st.sampled_from([tube(12, 8), tube(10, 6, bumps=0.2), sheet(8, 6)]))
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    for flaw in draw(st.lists(st.sampled_from(FLAWS), min_size=1, max_size=4)):
        mesh = flawed(mesh, flaw, random)
    return mesh
