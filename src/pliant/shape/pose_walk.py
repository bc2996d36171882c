"""Random steps of a pose: a rotation and a shift, as the first six numbers of a state.

A state is a rotation vector, a shift and then a model's coefficients. Steps are uniform over rotations, densities are
told per unit of the state: between the two stands the determinant of the exponential map, which a chain that forgot it
would pay with a bias towards some rotations (Chirikjian 2011, section 10.3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pliant.errors import InvalidParameter
from pliant.numerics.rigid.rotations import rotations_of
from pliant.shape.kernels import Floats, positive
from pliant.shape.sampling import Proposal, normal_density

SIZE = 6  # numbers of a pose


@dataclass(frozen=True)
class PoseWalk(Proposal):
    """Normal steps of the pose alone, the first six numbers of a state; the others stay.

    Parameters
    ----------
    angle
        The standard deviation of a turn about each axis, in radians, below 0.5.
    shift
        That of a shift along each axis, a length.
    """

    angle: float
    shift: float

    def __post_init__(self) -> None:
        if positive("the angle of a pose walk", self.angle) >= 0.5:
            raise InvalidParameter(f"the angle of a pose walk is {self.angle:g}; steps must be below 0.5 radians")
        positive("the shift of a pose walk", self.shift)

    def draw(self, state: Floats, random: np.random.Generator) -> Floats:
        new, turn = state.copy(), self.angle * random.standard_normal(3)
        new[:3] = rotation_vector(rotations_of(turn[None])[0] @ rotations_of(state[None, :3])[0])
        new[3:SIZE] += self.shift * random.standard_normal(3)
        return new

    def log_density(self, new: Floats, state: Floats) -> float:
        if not np.array_equal(new[SIZE:], state[SIZE:]):
            return -np.inf
        turn = rotation_vector(rotations_of(new[None, :3])[0] @ rotations_of(state[None, :3])[0].T)
        steps = np.concatenate([turn / self.angle, (new[3:SIZE] - state[3:SIZE]) / self.shift])
        volume = np.log(exponential_volume(new[:3])) - np.log(exponential_volume(turn))
        return float(normal_density(steps) - 3 * np.log(self.angle * self.shift) + volume)


def rotation_vector(matrix: Floats) -> Floats:
    """(3,) axis times angle, at most π long, of a (3, 3) rotation."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(matrix).as_rotvec(), np.float64)


def exponential_volume(vector: Floats) -> float:
    """How much of the rotations a unit of (3,) rotation vectors covers there: 2 (1 − cos θ) / θ², 1 at zero."""
    half = float(np.linalg.norm(vector)) / 2
    return float(np.sinc(half / np.pi) ** 2)


def turning_rate(vector: Floats) -> Floats:
    """(3, 3) J with exp(r + dr) = exp(J dr) exp(r), the left Jacobian (Chirikjian 2011, eq. 10.86)."""
    square = float(vector @ vector)
    x, y, z = vector
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if square < 1e-8:
        one, two = 0.5 - square / 24, 1 / 6 - square / 120
    else:
        angle = np.sqrt(square)
        one, two = (1 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    return np.asarray(np.eye(3) + one * cross + two * cross @ cross)


def pose_matrix(state: Floats, center: Floats, scale: float = 1.0) -> Floats:
    """(4, 4) the turn about a centre, with a scale, and the shift of a state's first six numbers."""
    matrix = np.eye(4)
    matrix[:3, :3] = scale * rotations_of(state[None, :3])[0]
    matrix[:3, 3] = center + state[3:SIZE] - matrix[:3, :3] @ center
    return matrix
