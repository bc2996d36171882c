"""Displacements added up: the laws of deformers, and the sum itself."""

import numpy as np
import pytest

from pliant.errors import InvalidDeformer
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.space.summed import Summed
from pliant.testing import check_deformer


def lattice(points, shape, seed):
    ffd = BSplineFFD.around(points, shape=shape)
    return ffd.moved(ffd.rest + np.random.default_rng(seed).normal(size=ffd.rest.shape) * 0.03)


def test_laws(random):
    points = random.random((200, 3)) * [2, 3, 1]
    check_deformer(Summed((lattice(points, (4, 4, 4), 0), lattice(points, (7, 6, 5), 1))), points)


def test_displacements_add_up(random):
    points = random.random((50, 3))
    parts = (Affine.rotation("x", 0.3), lattice(points, (4, 5, 6), 0), Affine.translation((1, 2, 3)))
    expected = points + sum(part(points) - points for part in parts)
    assert np.abs(Summed(parts)(points) - expected).max() < 1e-14


def test_nothing_is_no_sum():
    with pytest.raises(InvalidDeformer, match="at least one"):
        Summed(())
