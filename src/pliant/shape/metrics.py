"""How good a model is: compactness, generalisation and specificity (Davies 2002; Styner et al. 2003).

Distances are root mean squares over the vertices, in the mesh's unit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.errors import InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.shape.basis import Floats
from pliant.shape.linear_model import LinearModel
from pliant.shape.pca import learn_model
from pliant.shape.procrustes import align as aligning
from pliant.shape.procrustes import moved


def compactness(model: LinearModel) -> Floats:
    """(rank,) which part of the variance the first fields hold, one after the other: 1 at the end.

    Parameters
    ----------
    model
        Any model, from a kernel or learnt.
    """
    total = np.cumsum(model.variances)
    return np.asarray(total / total[-1])


def generalization(model: LinearModel, shapes: Sequence[PolygonMesh]) -> Floats:
    """(s,) how far shapes that the model has not seen are from the nearest that it can make.

    Parameters
    ----------
    model
        Any model.
    shapes
        s meshes with the model's vertices, where the model is.
    """
    return np.asarray([_apart(model.project(each), each.points) for each in shapes])


def leave_one_out(
    meshes: Sequence[PolygonMesh], *, rank: int | None = None, align: bool = True, scale: bool = False
) -> Floats:
    """(s,) for each example, how far it is from what a model of all others makes of it.

    Parameters
    ----------
    meshes
        s examples with the same vertices.
    rank
        How many fields the models keep; None = all.
    align, scale
        Whether poses, and sizes, are taken out first, as by :func:`~pliant.shape.pca.learn_model`.

    Returns
    -------
    (s,) array
        Root mean square distances between corresponding vertices, in the meshes' unit.

    Raises
    ------
    InvalidParameter
        Fewer than three examples.
    """
    if len(meshes) < 3:
        raise InvalidParameter(f"leaving one out needs three examples or more, not {len(meshes)}")
    errors = []
    for number, left in enumerate(meshes):
        others = [each for at, each in enumerate(meshes) if at != number]
        model = learn_model(others, rank=rank, align=align, scale=scale)
        points = _onto(left.points, model.mean, scale=scale) if align else left.points
        errors.append(_apart(model.project(points), points))
    return np.asarray(errors)


def specificity(
    model: LinearModel, meshes: Sequence[PolygonMesh], *, samples: int = 1000, seed: int = 0, align: bool = True
) -> float:
    """How far random shapes of the model are from the nearest example, in the mean, in the mesh's unit.

    Parameters
    ----------
    model
        Any model.
    meshes
        Examples with the model's vertices.
    samples
        How many random shapes are compared.
    seed
        Of their coefficients.
    align
        Whether examples are moved onto the mean first.

    Raises
    ------
    InvalidParameter
        No example, or no sample.
    """
    if not meshes or samples < 1:
        raise InvalidParameter("specificity compares at least one sample with at least one example")
    known = [_onto(each.points, model.mean) if align else each.points for each in meshes]
    shapes = model.sample(samples, seed=seed)
    distances = np.stack([np.sqrt(((shapes - each) ** 2).sum(axis=2).mean(axis=1)) for each in known])
    return float(distances.min(axis=0).mean())


def _onto(points: Floats, mean: Floats, *, scale: bool = False) -> Floats:
    return moved(aligning(points, mean, scale=scale), points)


def _apart(one: Floats, two: Floats) -> float:
    return float(np.sqrt(((one - two) ** 2).sum(axis=1).mean()))
