"""A map of space that ends its process where it meets a certain shape."""

import os
from dataclasses import dataclass

import numpy as np

from pliant.space.twist import Twist


@dataclass(frozen=True, eq=False)
class Deadly(Twist):
    """A twist; but shapes that reach below zero kill whoever twists them."""

    def _deformed(self, target):
        if np.asarray(target).min(axis=0)[2] < -10:
            os._exit(9)
        return super()._deformed(target)
