"""What of a face is its owner's, and what is only an expression."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pliant.face.expressions import expression_fields
from pliant.face.topology import mean_face
from pliant.mesh import Points

Floats = NDArray[np.float64]

UNEXPLAINED = 0.35  # centimetres, a standard deviation: how far faces without an expression are from the mean
ALIKE = 20  # landmarks that are off together: so few of them count as one
STRENGTH = 1.0  # a standard deviation: how strong expressions are


@dataclass(frozen=True, eq=False)
class Difference:
    """A face less the mean face, in two parts.

    Parameters
    ----------
    identity, expression
        (468, 3) displacements, whose sum is the difference.
    strengths
        (e,) how much there is of each of :data:`pliant.face.expressions.EXPRESSIONS`.
    """

    identity: Points
    expression: Points
    strengths: Floats


def difference_from_mean(landmarks: Points) -> Difference:
    """The difference of (468, 3) landmarks from the mean face.

    Expressions are fitted by least squares with a normal prior of their strengths: the mean of a Bayesian linear model
    with ``UNEXPLAINED`` as its noise. What they explain is expression, the rest identity.
    """
    whole = landmarks - mean_face().points
    fields = expression_fields()
    table = fields.reshape(len(fields), -1).T
    precision = np.full(len(fields), ALIKE * (UNEXPLAINED / STRENGTH) ** 2)
    strengths = np.asarray(
        np.linalg.solve(table.T @ table + np.diag(precision), table.T @ whole.reshape(-1)), np.float64
    )
    shown = np.tensordot(strengths, fields, axes=1)
    return Difference(whole - shown, shown, strengths)
