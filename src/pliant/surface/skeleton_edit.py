"""Contour-mean skeleton editing: the skeleton follows the handle, and details are put back, turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Target
from pliant.errors import InvalidDeformer
from pliant.mesh import PolygonMesh
from pliant.numerics.meshes.geodesics import geodesic_distance
from pliant.numerics.meshes.laplacians import cotangent_weights
from pliant.surface.cells import Cells
from pliant.surface.constraints import Constraints, constrain
from pliant.surface.contour_skeletons import ContourSkeleton, known_skeleton
from pliant.surface.editing import SurfaceDeformer
from pliant.surface.limb_twist import LimbTwist
from pliant.surface.skeleton_binding import RigidSkeletonBinding, SkeletonBinding, SmoothDisplacements
from pliant.surface.skeleton_motion import Band, SkeletonMotion, parents_of

Floats = NDArray[np.float64]
Finish = Literal["none", "smooth", "rigid"]
Profile = Callable[[Floats], Floats]

_SMOOTHED = 0.12  # of the way from the edge to the handle: over what length "smooth" smooths
_CHOICES = {"falloff": ("linear", "quadratic"), "turning": ("axis", "links"), "finish": ("none", "smooth", "rigid")}


@dataclass(frozen=True, eq=False)
class SkeletonEdit(SurfaceDeformer):
    """Edit a limb by its contour-mean skeleton: the mean of the handle goes where the mean of its goal is.

    About the limb's direction, from the region's fixed edge to the handle, the handle turns as the rotation that fits
    its goal best does, and the region is twisted by parts of that angle. What else the goal turns by is not seen: the
    limb swings as the mean says.

    Parameters
    ----------
    roi
        The region of interest: indices of vertices, or a mask of all. What lies outside stays, bit by bit.
    handle
        Vertices in the region that the user moves, likewise.
    goal
        (h, 3) where the handle's vertices shall be: the controls; None = where they are.
    eigenvectors, contours, scalar
        Of the skeleton, see :func:`contour_skeleton`.
    falloff
        ``"linear"``: the skeleton turns about the region's edge; ``"quadratic"``: it bends.
    turning
        ``"axis"``: all details turn about (v_h - a) × (v_h' - a); ``"links"``: each group as the links of the skeleton
        around it do.
    profile
        The part of the angle by which details turn, for (k,) parts t of the way from the edge, 0, to the handle, 1:
        t → [0, 1]; None = :class:`Band`.
    finish
        ``"none"``: as the skeleton says, with steps where groups meet; ``"smooth"``: displacements are smoothed by
        the cotangent Laplacian; ``"rigid"``: the deformed mesh is the guess of some as-rigid-as-possible iterations,
        which keep the differential coordinates.
    iterations
        How many, for ``"rigid"``.
    """

    eigenvectors: int = field(default=10, kw_only=True)
    contours: int = field(default=30, kw_only=True)
    scalar: ArrayLike | str | None = field(default=None, kw_only=True)
    falloff: Literal["linear", "quadratic"] = field(default="linear", kw_only=True)
    turning: Literal["axis", "links"] = field(default="axis", kw_only=True)
    profile: Profile | None = field(default=None, kw_only=True)
    finish: Finish = field(default="smooth", kw_only=True)
    iterations: int = field(default=20, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, known in _CHOICES.items():
            if getattr(self, name) not in known:
                raise InvalidDeformer(f"{name} is {getattr(self, name)!r}; there are: {', '.join(known)}")
        if self.contours < 1 or self.eigenvectors < 2 or self.iterations < 1:
            raise InvalidDeformer("a skeleton needs at least 2 eigenvectors, 1 contour and 1 iteration")

    def bind(self, target: Target) -> SkeletonBinding | RigidSkeletonBinding:
        mesh = self._mesh(target)
        weights = cotangent_weights(mesh.points, mesh.triangles)
        constraints = constrain(mesh, np.asarray(self.roi), np.asarray(self.handle), weights)
        skeleton = known_skeleton(mesh, self.contours, self.scalar, self.eigenvectors)
        along = _along(mesh, constraints)
        moving = np.flatnonzero(_inside(constraints, len(along)) & np.isfinite(along) & (skeleton.groups >= 0))
        way = float(along[constraints.handle].mean())
        smooth = None
        if self.finish == "smooth":
            smooth = SmoothDisplacements(mesh, weights, constraints.free, _SMOOTHED * way)
        motion = self._motion(mesh, skeleton, constraints, moving, along / way, smooth)
        bound = mesh.points, constraints, self.goal, skeleton, motion, moving
        if self.finish == "rigid":
            return RigidSkeletonBinding(*bound, Cells(mesh.points, weights, constraints.free), self.iterations)
        return SkeletonBinding(*bound, smooth)

    def _motion(
        self,
        mesh: PolygonMesh,
        skeleton: ContourSkeleton,
        constraints: Constraints,
        moving: NDArray[np.int64],
        t: Floats,
        smooth: SmoothDisplacements | None,
    ) -> SkeletonMotion:
        used, groups = np.unique(skeleton.groups[moving], return_inverse=True)
        groups = groups.reshape(-1)
        part = np.clip(np.bincount(groups, weights=t[moving]) / np.bincount(groups), 0.0, 1.0)
        part[groups[np.isin(moving, constraints.handle)]] = 1.0
        place = np.full(len(skeleton.points), -1)
        place[used] = np.arange(len(used))
        links = place[skeleton.links]
        edge, handle = mesh.points[constraints.belt].mean(axis=0), mesh.points[constraints.handle].mean(axis=0)
        centers = np.tile(edge, (len(mesh.points), 1))
        centers[moving] = np.where((part >= 1)[:, None], handle, skeleton.points[used])[groups]
        if smooth is not None:
            smooth(centers)
        spin = np.clip(t[moving] / max(float(t[constraints.handle].min()), 1e-9), 0.0, 1.0)
        profile = Band() if self.profile is None else self.profile
        return SkeletonMotion(
            details=mesh.points[moving] - skeleton.points[used][groups],
            groups=groups.astype(np.int64),
            points=skeleton.points[used],
            follow=part**2 if self.falloff == "quadratic" else part,
            turn=np.asarray(profile(np.clip(t[moving], 0.0, 1.0)), np.float64),
            parents=parents_of(links[(links >= 0).all(axis=1)], part),
            edge=edge,
            handle=handle,
            by_links=self.turning == "links",
            twist=LimbTwist.along(mesh.points[moving], centers[moving], spin, edge, handle),
        )


def _inside(constraints: Constraints, count: int) -> NDArray[np.bool_]:
    inside = np.zeros(count, bool)
    inside[constraints.free] = inside[constraints.handle] = True
    return inside


def _along(mesh: PolygonMesh, constraints: Constraints) -> Floats:
    """(n,) how far each vertex is from the region's fixed edge; infinite where the handle cannot be reached from."""
    if not len(constraints.belt):
        raise InvalidDeformer(
            "the region of interest has no fixed edge: SkeletonEdit turns about one; leave some of the mesh out of roi"
        )
    along = geodesic_distance(mesh.points, mesh.triangles, constraints.belt)
    if not np.isfinite(along[constraints.handle]).all():
        far = constraints.handle[~np.isfinite(along[constraints.handle])][0]
        raise InvalidDeformer(f"no path leads from the region's fixed edge to handle vertex {far}: leave it out")
    reach = geodesic_distance(mesh.points, mesh.triangles, constraints.handle)
    return np.where(np.isfinite(reach), along, np.inf)
