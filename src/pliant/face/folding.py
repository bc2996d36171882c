"""A deformation of a face, as far as it goes without folding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.field.certifying import certify
from pliant.field.limiting import limit_to_fold_free
from pliant.mesh import PolygonMesh
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.dirichlet_ffd import DirichletFFD

Floats = NDArray[np.float64]

MARGIN = 0.05  # the least det J that is left
FEW = 5000  # faces, of which the middles are looked at too
STEPS = 200  # looked at between rest and all of the deformation


@dataclass(frozen=True, eq=False)
class Foldless:
    """A deformer that does not fold.

    Parameters
    ----------
    deformer
        The deformer, its displacements scaled down where they would fold.
    part
        By how much: 1 = not at all.
    least
        The least det J found.
    proved
        Whether it is proved that det J > 0 in all of space.
    """

    deformer: DirichletFFD | BSplineFFD
    part: float
    least: float
    proved: bool


def without_folds(deformer: DirichletFFD | BSplineFFD, mesh: PolygonMesh) -> Foldless:
    """A deformer with the largest part of its displacements that keeps det J above a margin, from rest up to it.

    For a lattice this is proved in all of space; with sites, the vertices of the mesh are looked at, and the middles
    of its faces where these are few.
    """
    if isinstance(deformer, BSplineFFD):
        limited = limit_to_fold_free(deformer, MARGIN)
        proof = certify(limited)
        whole = float(np.abs(deformer.controls - deformer.rest).max())
        part = float(np.abs(limited.controls - limited.rest).max()) / whole if whole else 1.0
        return Foldless(limited, part, proof.lower, proof.status == "fold-free")
    places = mesh.points
    if len(mesh.faces) < FEW:
        places = np.vstack([places, mesh.points[mesh.triangles].mean(axis=1)])
    part, least = _largest_part(deformer.jacobian(places) - np.eye(3))
    scaled = deformer.moved(deformer.rest + part * (deformer.controls - deformer.rest))
    return Foldless(scaled if part < 1 else deformer, part, least, proved=False)


def _largest_part(slopes: Floats) -> tuple[float, float]:
    """The largest t for which det(I + s B) stays above the margin for all s up to t, for all (n, 3, 3) B; and det J.

    The determinant is 1 + s tr B + s^2 (tr^2 B - tr B^2) / 2 + s^3 det B.
    """
    trace = np.trace(slopes, axis1=1, axis2=2)
    second = (trace**2 - np.einsum("nij,nji->n", slopes, slopes)) / 2
    third = np.linalg.det(slopes)
    steps = np.linspace(0, 1, STEPS + 1)
    least = np.array([(1 + s * (trace + s * (second + s * third))).min() for s in steps])
    folded = np.flatnonzero(least < MARGIN)
    last = int(folded[0]) - 1 if len(folded) else STEPS
    return float(steps[last]), float(least[last])
