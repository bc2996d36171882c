"""Models learnt from shapes in correspondence: principal components (Cootes et al. 1995)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pliant.errors import InvalidMesh, InvalidParameter
from pliant.mesh import PolygonMesh
from pliant.numerics.given import as_count
from pliant.shape.basis import FullBasis
from pliant.shape.model import ShapeModel
from pliant.shape.procrustes import generalized_procrustes

NEGLIGIBLE = 1e-10  # of the largest eigenvalue: what is less is rounding


def learn_model(
    meshes: Sequence[PolygonMesh], *, align: bool = True, scale: bool = False, rank: int | None = None
) -> ShapeModel:
    """The model of examples: their mean, and the directions in which they differ most.

    Parameters
    ----------
    meshes
        Two or more with the same vertices in the same order.
    align
        Whether to take positions and rotations out first, by generalised Procrustes.
    scale
        Whether to take sizes out too.
    rank
        At most so many fields; None = all, one less than there are examples.

    Returns
    -------
    ShapeModel
        What its first fields leave out is in ``noise_variance``, the mean squared residual a coordinate.

    Raises
    ------
    InvalidMesh
        Examples with other numbers of vertices, or all alike.
    InvalidParameter
        Fewer than two, or a rank below one.
    """
    if len(meshes) < 2:
        raise InvalidParameter(f"a model is learnt from two examples or more, not from {len(meshes)}")
    if rank is not None and as_count("the rank", rank, InvalidParameter) < 1:
        raise InvalidParameter(f"the rank is {rank}; a model needs at least one field")
    count = len(meshes[0].points)
    for number, each in enumerate(meshes):
        if len(each.points) != count:
            raise InvalidMesh(
                f"example {number} has {len(each.points):,} vertices, the first {count:,}: fit a model to them"
            )
    shapes = np.stack([each.points for each in meshes])
    mean = shapes.mean(axis=0)
    if align:
        shapes, _ = generalized_procrustes(shapes, scale=scale)
        mean = shapes.mean(axis=0)
    rows = (shapes - mean).reshape(len(shapes), -1) / np.sqrt(len(shapes) - 1)
    _, deviations, directions = np.linalg.svd(rows, full_matrices=False)
    size = float(np.abs(mean - mean.mean(axis=0)).max()) or 1.0
    real = int((deviations**2 > NEGLIGIBLE * max(float(deviations[0]) ** 2, (1e-9 * size) ** 2)).sum())
    if not real:
        raise InvalidMesh("the examples are all alike: there is nothing to learn from them")
    kept = real if rank is None else min(rank, real)
    fields = (directions[:kept].T * deviations[:kept]).reshape(count, 3, kept)
    noise = float((deviations[kept:] ** 2).sum()) / (3 * count)
    reference = meshes[0].with_points(mean)
    return ShapeModel(reference, mean, FullBasis(fields, deviations[:kept]), noise_variance=noise)
