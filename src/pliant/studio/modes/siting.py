"""Sites of a free-form deformation without a lattice: placed on the surface, mirrored, taken away.

A site rests where the shape was before the layer, and begins where the layer has already put that place: so placing
one moves nothing there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.meshes.closest_surface import TriangleSearch
from pliant.space.dirichlet_ffd import SAME, DirichletFFD

ON = 0.05  # of the diagonal: a mirror image that is this near to the surface is put onto it
APART = 1e-4  # of the diagonal: nearer ones are one
LEAST = 2


def with_sites(deformer: DirichletFFD, places: Points, smallest: float) -> DirichletFFD:
    """A deformer with more sites, (k, 3) at rest; those that are there already are left out.

    Parameters
    ----------
    deformer
        The one that there is.
    places
        Where they rest.
    smallest
        The least distance between two sites.

    Raises
    ------
    InvalidParameter
        All of them are there already.
    """
    new = [place for place in places if np.linalg.norm(deformer.sites - place, axis=1).min() > smallest]
    if not new:
        raise InvalidParameter("there is a site already: click farther from it")
    added = np.array(new)
    moves = np.concatenate([deformer.controls - deformer.sites, deformer(added) - added])
    return replace(deformer, sites=np.concatenate([deformer.sites, added]), displacements=moves)


def without_sites(deformer: DirichletFFD, chosen: NDArray[np.int64]) -> DirichletFFD:
    """A deformer with fewer sites.

    Raises
    ------
    InvalidParameter
        Fewer than two would be left.
    """
    kept = np.setdiff1d(np.arange(len(deformer.sites)), chosen)
    if len(kept) < LEAST:
        raise InvalidParameter("two sites must be left: delete the layer to be rid of all")
    moves = deformer.controls - deformer.sites
    return replace(deformer, sites=deformer.sites[kept], displacements=moves[kept])


def mirrored(places: Points, mesh: PolygonMesh, axis: int) -> Points:
    """(k, 3) places on the other side of the middle of a mesh; on its surface, where that is near."""
    images = np.array(places)
    images[:, axis] = 2 * mesh.center[axis] - images[:, axis]
    if not len(mesh.triangles) or not len(images):
        return images
    found = TriangleSearch(mesh.points, mesh.triangles.astype(np.int64)).query(images)
    near = np.linalg.norm(found.points - images, axis=1) < ON * mesh.diagonal
    images[near] = found.points[near]
    return images


def apart(diagonal: float) -> float:
    """How far sites must be from each other."""
    return max(APART, 10 * SAME) * diagonal
