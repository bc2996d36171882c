"""Free-form deformation by control points anywhere, without a lattice (Moccozet & Magnenat-Thalmann 1997)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, eye_array, vstack

from pliant.deformer import Controls, SpaceDeformer, Target, checked_controls
from pliant.errors import InvalidDeformer
from pliant.mesh import as_points
from pliant.numerics.given import as_numbers
from pliant.numerics.neighbors.ghost_box import GhostBox
from pliant.numerics.ragged import frozen
from pliant.space.sparse import SparseBinding

LEAST_MARGIN = 0.25
SAME = 1e-9  # sites closer than this part of their diagonal are one


@dataclass(frozen=True, eq=False)
class DirichletFFD(SpaceDeformer):
    """Free-form deformation by sites: control points anywhere in space, no lattice, no connections.

    A point moves by the sum of its natural neighbours' displacements times its coordinates with respect to them
    (Moccozet & Magnenat-Thalmann 1997, eq. 4). The coordinates are not negative and sum to one; linear functions
    are reproduced; a site influences only the points that would take a piece of its Voronoi cell.

    Eight ghost sites at the corners of a box around the sites stay at rest: displacements fade towards the box, and
    points outside it do not move.

    Parameters
    ----------
    sites
        (k, 3) control points at rest: two or more, anywhere, also in a plane, on a line or on a regular grid.
    smooth
        Whether displacements are interpolated by Farin's (1990) cubic form, which is C1 at the sites too and
        reproduces quadratic functions; gradients at the sites are fitted to the sites around. Else the form is C0
        at the sites.
    coordinates
        ``"sibson"``: by the volume that a point would take from each cell (Sibson 1980). ``"laplace"``: by the
        areas of the facets of its own cell over the distances; less smooth.
    margin
        Distance of the ghosts' box from the sites' bounding box, as a part of the sites' diagonal.
    displacements
        (k, 3) displacement of each site; None = at rest.

    Raises
    ------
    InvalidDeformer
        Fewer than two sites, two in one place, values that are not finite, a margin below a quarter.
    """

    sites: Controls
    smooth: bool = False
    coordinates: Literal["sibson", "laplace"] = "sibson"
    margin: float = 1.0
    displacements: Controls | None = None

    def __post_init__(self) -> None:
        sites = frozen(_checked_sites(self.sites), np.float64)
        if self.coordinates not in ("sibson", "laplace"):
            raise InvalidDeformer(f"coordinates are {self.coordinates!r}; they must be 'sibson' or 'laplace'")
        if not LEAST_MARGIN <= self.margin <= 1e3:
            raise InvalidDeformer(f"margin is {self.margin}; it must be {LEAST_MARGIN} or more, and at most 1000")
        moves = (
            np.zeros_like(sites)
            if self.displacements is None
            else as_numbers("displacements", self.displacements, InvalidDeformer)
        )
        if moves.shape != sites.shape or not np.isfinite(moves).all():
            raise InvalidDeformer(f"displacements must be finite and of shape {sites.shape}; theirs is {moves.shape}")
        object.__setattr__(self, "sites", sites)
        object.__setattr__(self, "displacements", frozen(moves, np.float64))

    @property
    def rest(self) -> Controls:
        """(k, 3) the sites."""
        return self.sites

    @property
    def controls(self) -> Controls:
        return np.asarray(self.sites + self._moves)

    def moved(self, controls: ArrayLike) -> Self:
        other = replace(self, displacements=checked_controls(controls, self.sites.shape) - self.sites)
        other.__dict__["_box"] = self._box  # cells depend on the sites only
        return other

    def bind(self, target: Target) -> SparseBinding:
        points = as_points(target)
        if not self.smooth:
            return SparseBinding(points, self._box.weights(points), None, self.sites, self._moves)
        basis, expansion = self._box.smooth_weights(points), self._with_gradients
        return SparseBinding(points, basis, expansion, self.sites, self._moves)

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3, 3) the derivative; at a site of the plain form, which has none there, that of the fitted function."""
        return np.eye(3) + self._box.slope(as_points(points), self._moves, smooth=self.smooth)

    @property
    def _moves(self) -> Controls:
        assert self.displacements is not None
        return self.displacements

    @cached_property
    def _box(self) -> GhostBox:
        return GhostBox(self.sites, self.margin, self.coordinates)

    @property
    def _with_gradients(self) -> csr_array:
        """(4 k, k) from displacements to displacements and their gradients."""
        return csr_array(vstack([eye_array(len(self.sites)), self._box.fit]))


def _checked_sites(sites: ArrayLike) -> Controls:
    from scipy.spatial import cKDTree

    array = as_numbers("sites", sites, InvalidDeformer)
    if array.ndim != 2 or array.shape[1] != 3 or len(array) < 2:
        raise InvalidDeformer(f"sites have shape {array.shape}; (k, 3) is needed, with two sites or more")
    if not np.isfinite(array).all():
        bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
        raise InvalidDeformer(f"{len(bad)} of {len(array)} sites are not finite, the first is site {bad[0]}")
    diagonal = float(np.linalg.norm(np.ptp(array, axis=0)))
    pairs = cKDTree(array).query_pairs(SAME * diagonal, output_type="ndarray")
    if len(pairs):
        first, second = sorted(map(tuple, np.sort(pairs, axis=1).tolist()))[0]
        raise InvalidDeformer(
            f"sites {first} and {second} are in the same place, {array[first].tolist()}; {len(pairs)} pairs are: "
            "keep one of each"
        )
    return array
