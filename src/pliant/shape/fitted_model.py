"""Models fitted to meshes of any topology: by closest points and conditioning in turn, or by descent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pliant.mesh import PolygonMesh
from pliant.shape.changeable_model import ChangeableModel
from pliant.shape.registration import Fit, Pose, Watch, fit
from pliant.shape.robust import Loss


@dataclass(frozen=True, eq=False, repr=False)
class FittedModel(ChangeableModel):
    """A model that is fitted to meshes."""

    def fit(
        self,
        mesh: PolygonMesh,
        *,
        iterations: int = 50,
        noise: float | None = None,
        start_noise: float | None = None,
        pose: Pose | None = None,
        loss: Loss = "huber",
        angle: float = np.pi / 3,
        slide: float = 3.0,
        watch: Watch | None = None,
    ) -> Fit:
        """The model's shape that lies on a mesh of any topology: GP-ICP, no correspondence needed.

        To use landmarks, fit their :meth:`~pliant.ShapeModel.posterior`.

        Parameters
        ----------
        mesh
            The target: a mesh, a part of one, or bare points.
        iterations
            At most so many rounds.
        noise
            The standard deviation of the target's points at last, a length; None = a thousandth of the diagonal.
        start_noise
            At first; it shrinks from round to round. None = a fiftieth of the diagonal.
        pose
            None = model and target lie in one space. ``"rigid"`` moves and turns the model too, beginning with the
            centres of both; ``"similarity"`` scales it as well.
        loss
            How distances count: ``"squares"``, ``"huber"``, or ``"tukey"``, which leaves far points out.
        angle
            Normals that differ by more, in radians, do not correspond.
        slide
            How many times farther a point may move along the target than off it.
        watch
            Told after each round how far the fit has come; what it raises ends the fit.

        Raises
        ------
        InvalidParameter, InvalidTarget
            No iterations, noise that is not positive, a target without points.
        NotConverged
            Almost nothing of the shape corresponds to the target.
        """
        return fit(
            self,
            mesh,
            iterations=iterations,
            noise=noise,
            start_noise=start_noise,
            pose=pose,
            loss=loss,
            angle=angle,
            slide=slide,
            watch=watch,
        )

    def descend(
        self,
        mesh: PolygonMesh,
        *,
        start: ArrayLike | None = None,
        iterations: int = 50,
        levels: int = 4,
        noise: float | None = None,
        start_noise: float | None = None,
        pose: Pose | None = None,
        loss: Loss = "huber",
        angle: float = np.pi / 3,
    ) -> Fit:
        """The model's shape of the least robust distance from a mesh, from coarse to fine, with exact gradients.

        It has converged when the least energy is within a tenth of a standard deviation of what the target leaves open,
        as Gauss–Newton's curvature tells; else its status is ``"stopped"``.

        Parameters
        ----------
        mesh
            The target: a mesh, a part of one, or bare points.
        start
            (k,) coefficients to begin with, as of :meth:`fit`; None = the mean.
        iterations
            At most so many a level.
        levels
            How many: each has twice the vertices and fields of the one before, and less noise.
        noise, start_noise, loss, angle
            As for :meth:`fit`.
        pose
            ``"rigid"``: the model is moved and turned too, beginning where it lies. ``"similarity"``: scaled as well,
            beginning in the middle of the target and as large; noise is then in the model's unit of length.

        Raises
        ------
        InvalidParameter, InvalidTarget, NotConverged
            As :meth:`fit`.
        """
        from pliant.shape.descent import descend

        return descend(
            self,
            mesh,
            start=start,
            iterations=iterations,
            levels=levels,
            noise=noise,
            start_noise=start_noise,
            pose=pose,
            loss=loss,
            angle=angle,
        )
