"""Fitting a model to a mesh without correspondence: closest points, then the most likely shape, and again (GP-ICP).

Each round conditions the model on the points of the target that are closest to its present shape (Lüthi et al. 2018,
section 4.3). The noise shrinks from round to round: at first only the strongest fields answer, at last all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter, InvalidTarget, NotConverged
from pliant.mesh import Points, PolygonMesh
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.shape import robust
from pliant.shape.basis import Floats
from pliant.shape.correspondence import Target, vertex_normals
from pliant.shape.kernels import positive
from pliant.shape.posterior import Noise, along_and_across, most_likely
from pliant.shape.procrustes import align, moved

if TYPE_CHECKING:
    from pliant.shape.linear_model import LinearModel

Pose = Literal["rigid", "similarity"]

SETTLED = 1e-3  # of the last noise: a shape that moves less has converged
_UNITS = 50.0  # times larger or smaller: not one unit of length
_START = 0.02  # of the diagonal: the noise of the first round
_FINAL = 1e-3  # of the diagonal: that of the last
_MOST = 4000  # vertices that look for closest points: more say little more


@dataclass(frozen=True, eq=False)
class Fit:
    """A model's shape fitted to a target.

    Parameters
    ----------
    coefficients
        (k,) in standard deviations.
    points
        (n, 3) the shape where the target is: after the pose.
    pose
        (4, 4) from the model's space to the target's.
    distance
        The mean distance of the shape's vertices, 4,000 of them at most, from the target: a length.
    status
        ``"converged"``, or ``"stopped"`` at the largest number of iterations.
    iterations
        How many it took.
    """

    coefficients: Floats
    points: Points
    pose: Floats
    distance: float
    status: Literal["converged", "stopped"]
    iterations: int


@dataclass(frozen=True, eq=False)
class Round:
    """How far a fit has come.

    Parameters
    ----------
    number, most
        Which round this was, and how many there will be at most.
    coefficients
        (k,) of the shape now, in standard deviations.
    pose
        (4, 4) from the model's space to the target's.
    """

    number: int
    most: int
    coefficients: Floats
    pose: Floats


Watch = Callable[[Round], None]


def fit(
    model: LinearModel,
    mesh: PolygonMesh,
    *,
    iterations: int = 50,
    noise: float | None = None,
    start_noise: float | None = None,
    pose: Pose | None = None,
    loss: robust.Loss = "huber",
    angle: float = np.pi / 3,
    slide: float = 3.0,
    watch: Watch | None = None,
) -> Fit:
    """Fit by GP-ICP; parameters as for :meth:`pliant.ShapeModel.fit`."""
    last, first = checked_noise(model, noise, start_noise)
    if iterations < 1 or pose not in (None, "rigid", "similarity"):
        raise InvalidParameter(
            f"a fit has at least one iteration, and a pose 'rigid', 'similarity' or None, not {pose!r}"
        )
    checked_target(model, mesh, pose)
    rounds = _Rounds(model, Target(mesh, angle), pose, loss, max(1.0, slide))
    status: Literal["converged", "stopped"] = "stopped"
    count = 0
    with one_blas_thread():
        for count in range(1, iterations + 1):
            level = max(last, first * (last / first) ** (1.25 * (count - 1) / max(1, iterations - 1)))
            step = rounds.advance(level)
            if watch is not None:
                watch(rounds.told(count, iterations))
            if level == last and step < SETTLED * last:
                status = "converged"
                break
    return rounds.result(status, count)


def checked_noise(model: LinearModel, noise: float | None, start_noise: float | None) -> tuple[float, float]:
    """The noise at last and at first.

    Raises
    ------
    InvalidParameter
        Noise that is not positive.
    """
    size = model.reference.diagonal or 1.0
    last = positive("the noise", _FINAL * size if noise is None else noise)
    return last, max(last, positive("the noise at the start", _START * size if start_noise is None else start_noise))


def checked_target(model: LinearModel, mesh: PolygonMesh, pose: Pose | None) -> None:
    """See that a target can be the model's.

    Raises
    ------
    InvalidTarget
        No points, another unit of length, or far from a model that may not move.
    """
    if not len(mesh.points):
        raise InvalidTarget("the target has no points: there is nothing to fit to")
    size, other = model.reference.diagonal, mesh.diagonal
    if pose != "similarity" and size > 0 and not size / _UNITS < max(other, 1e-300) < size * _UNITS:
        raise InvalidTarget(
            f"the target's diagonal is {other:.4g}, the model's {size:.4g}: are both in one unit of length? Scale one, "
            "or fit with pose='similarity'"
        )
    (low, high), (low_there, high_there) = model.reference.with_points(model.mean).bounds, mesh.bounds
    gap = float(np.linalg.norm(np.maximum(np.maximum(low - high_there, low_there - high), 0.0)))
    if pose is None and gap > size:
        raise InvalidTarget(
            f"the target is {gap:.4g} away from the model, which is {size:.4g} large: give pose='rigid' for the model "
            "to move"
        )


class _Rounds:
    """What changes from round to round: the coefficients and the pose."""

    def __init__(
        self,
        model: LinearModel,
        target: Target,
        pose: Pose | None,
        loss: robust.Loss,
        slide: float,
    ) -> None:
        self._model, self._target, self._pose, self._loss, self._slide = model, target, pose, loss, slide
        self._coefficients, self._matrix, self._shape = np.zeros(model.count), np.eye(4), model.mean
        self._triangles = model.reference.triangles
        self._near: NDArray[np.int64] | None = None
        self._chosen = np.arange(0, len(model.mean), -(-len(model.mean) // _MOST))
        self._rows = model.basis if len(self._chosen) == len(model.mean) else model.basis.rows(self._chosen)
        if pose is not None:
            self._matrix[:3, 3] = _middle(target.mesh) - _middle(model.reference.with_points(model.mean))

    def advance(self, level: float) -> float:
        """One round at a noise; how far the shape's vertices moved at most."""
        posed = moved(self._matrix, self._shape)
        normals = vertex_normals(posed, self._triangles)[self._chosen] if len(self._triangles) else None
        posed = posed[self._chosen]
        found = self._target.correspondences(posed, normals, self._near)
        places, self._near = found.places, found.triangles
        distance = np.linalg.norm(places - posed, axis=1)
        weights = robust.weights(distance / max(level, float(np.median(distance))), self._loss) * found.good
        used = np.flatnonzero(weights > 1e-6)
        if len(used) < 3:
            raise NotConverged(
                "fewer than three points of the shape correspond to the target: align it first, allow a larger angle, "
                "or turn normals that point inwards"
            )
        if self._pose is not None:
            scale = self._pose == "similarity"
            shape = self._shape[self._chosen[used]]
            self._matrix = align(shape, places[used], scale=scale, weights=weights[used])
        back = np.asarray(np.linalg.inv(self._matrix), np.float64)
        goals, size = moved(back, places[used]), float(np.linalg.det(back[:3, :3])) ** (1 / 3)
        precision = weights[used] / (level * size) ** 2
        if found.normals is not None and self._slide > 1.0:
            directions = found.normals[used] @ back[:3, :3].T / size
            precision = precision[:, None, None] * along_and_across(directions, 1.0, 1 / self._slide)
        new = self._conditioned(used, goals, Noise(precision, 0.0))
        step = new - self._shape
        self._shape = new
        return float(np.sqrt(np.einsum("ni,ni->n", step, step).max()))

    def _conditioned(self, used: NDArray[np.int64], goals: Floats, error: Noise) -> Points:
        model = self._model
        rows = self._rows if len(used) == len(self._chosen) else self._rows.rows(used)
        self._coefficients = most_likely(rows, goals - model.mean[self._chosen[used]], error)
        return model.instance(self._coefficients)

    def told(self, number: int, most: int) -> Round:
        return Round(number, most, self._coefficients, self._matrix)

    def result(self, status: Literal["converged", "stopped"], count: int) -> Fit:
        points = moved(self._matrix, self._shape)
        some = points[self._chosen]
        distance = np.linalg.norm(self._target.closest(some) - some, axis=1)
        return Fit(self._coefficients, points, self._matrix, float(distance.mean()), status, count)


def _middle(mesh: PolygonMesh) -> Floats:
    """(3,) the centre of the surface, or of the points where there is none."""
    if not len(mesh.triangles):
        return np.asarray(mesh.points.mean(axis=0))
    corners = mesh.points[mesh.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if not area.sum() > 0:
        return np.asarray(mesh.points.mean(axis=0))
    return np.asarray(area @ corners.mean(axis=1) / area.sum())
