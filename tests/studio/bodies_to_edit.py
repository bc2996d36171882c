"""Scenes that the tests of the studio show."""

import numpy as np

from pliant.scene.layer import Layer
from pliant.scene.scene import Scene
from pliant.scene.stack import Stack
from pliant.space.bspline_ffd import BSplineFFD
from pliant.studio.examples.samples import ball, torus


def round_scene(shape=(4, 4, 4)):
    """A torus in a lattice at rest."""
    mesh = torus(around=64, across=28)
    return Scene(mesh, Stack((Layer("Lattice", BSplineFFD.around(mesh, shape=shape, margin=0.05)),)))


def moved_scene():
    """A ball in a lattice of which a point has moved."""
    mesh = ball()
    lattice = BSplineFFD.around(mesh, margin=0.05)
    controls = np.array(lattice.rest)
    controls[1, 2, 3] += [0.1, -0.2, 0.6]
    return Scene(mesh, Stack((Layer("Lattice", lattice.moved(controls)),)))
