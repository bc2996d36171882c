"""A deformation corrected so that a mesh keeps its volume."""

from __future__ import annotations

import warnings
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pliant.deformer import Controls, Deformer, SpaceDeformer
from pliant.errors import InvalidDeformer, InvalidParameter, NotConverged, PliantWarning
from pliant.field.certifying import certify
from pliant.field.volumes import unchecked_gradient, unchecked_volume, volume
from pliant.mesh import PolygonMesh

Map = TypeVar("Map", bound=Deformer)

_SHARES = (1 / 3, 1 / 2, 1.0)  # of what is still missing, an axis: all axes bear a third


def preserve_volume(deformer: Map, mesh: PolygonMesh, free: ArrayLike | None = None) -> Map:
    """The deformation with its controls corrected so that a closed mesh keeps its volume, exactly.

    The volume is linear in the points' coordinates along each axis alone, and these are linear in the controls': a
    step of the controls along the volume's gradient, of the length that a linear equation gives, restores a third of
    the volume by x, half of the rest by y, and the rest by z. Among all corrections along an axis it is the smallest.

    Parameters
    ----------
    deformer
        A linear deformer whose controls are positions.
    mesh
        The closed mesh, before the deformation.
    free
        Which controls may be corrected: a mask shaped as the controls without their last axis; None = all.

    Returns
    -------
    Deformer
        Of the same kind: its volume of the deformed mesh is that of the mesh.

    Raises
    ------
    InvalidMesh
        The mesh is open, or its faces disagree about the outside.
    InvalidDeformer
        The controls are no positions.
    InvalidParameter
        A mask of another shape, or no free control changes the volume.
    NotConverged
        The deformer is not linear in its controls.

    Warns
    -----
    PliantWarning
        The corrected deformation folds where the given one was not known to.
    """
    rest = deformer.rest
    if rest.ndim < 2 or rest.shape[-1] != 3:
        raise InvalidDeformer(f"the controls of a {type(deformer).__name__} are no positions: it cannot be corrected")
    mask = _mask(free, rest.shape[:-1])
    wanted, bound, controls = volume(mesh), deformer.bind(mesh), deformer.controls.copy()
    for axis, share in enumerate(_SHARES):
        moved = mesh.with_points(bound.deform(controls))
        gradient = bound.vjp(controls, unchecked_gradient(moved))[..., axis] * mask
        controls[..., axis] += _step(gradient, share * (wanted - unchecked_volume(moved)))
    kept = deformer.moved(controls)
    found = unchecked_volume(mesh.with_points(bound.deform(controls)))
    if not np.isclose(found, wanted, rtol=1e-9, atol=0.0):
        name = type(deformer).__name__
        raise NotConverged(f"the volume is {found:.9g}, not {wanted:.9g}: a {name} is not linear in its controls")
    _warn_of_folds(deformer, kept)
    return kept


def _mask(free: ArrayLike | None, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    if free is None:
        return np.ones(shape, bool)
    mask = np.asarray(free)
    if mask.dtype != bool or mask.shape != shape:
        raise InvalidParameter(f"free is a mask of shape {shape}, a truth value a control; it has {mask.shape}")
    return mask


def _step(gradient: Controls, missing: float) -> Controls:
    """The smallest step that changes the volume by what is missing."""
    size = float((gradient * gradient).sum())
    if missing and not size:
        raise InvalidParameter("no free control changes the volume of the mesh: free others, or move the lattice")
    return gradient * (missing / size) if missing else np.zeros_like(gradient)


def _warn_of_folds(before: Deformer, after: Deformer) -> None:
    if isinstance(after, SpaceDeformer):
        proof = certify(after)
        if proof.status == "folds" and certify(before).status != "folds":
            warnings.warn(
                f"the corrected deformation folds: det J = {proof.least:.3g} at {proof.point}; deform less, or free "
                "more controls",
                PliantWarning,
                stacklevel=3,
            )
