"""A lattice that moves nothing where a point is not surrounded by 4 x 4 x 4 control points."""

import numpy as np
import pytest

from pliant.errors import InvalidDeformer
from pliant.space.affine import Affine
from pliant.space.bspline_ffd import BSplineFFD
from pliant.testing import check_deformer

AXES = Affine.rotation((1, 2, 3), 0.7).linear


def lattice(shape=(6, 5, 4), edge="identity", affine=None):
    values = np.random.default_rng(0).normal(size=(*shape, 3)) * 0.05
    affine = np.eye(4) if affine is None else affine
    return BSplineFFD(displacements=values, origin=(1, 2, 3), spacing=(1, 2, 3), axes=AXES, edge=edge, affine=affine)


def world(ffd, index):
    return ffd.origin + (index * ffd.spacing) @ ffd.axes.T


def test_laws(random):
    ffd = lattice()
    check_deformer(ffd, world(ffd, random.uniform(1.01, np.array(ffd.shape) - 2.01, (200, 3))))


def test_within_it_is_every_lattice_and_beyond_it_only_the_affine_part(random):
    affine = np.eye(4)
    affine[:3] += random.normal(size=(3, 4)) * 0.1
    ffd = lattice(affine=affine)
    last = np.array(ffd.shape) - 2
    inside = world(ffd, random.uniform(1, last, (200, 3)))
    for edge in ("clamp", "zero"):
        assert np.abs(ffd(inside) - lattice(edge=edge, affine=affine)(inside)).max() < 1e-14
    index = random.uniform(-3, np.array(ffd.shape) + 2, (500, 3))
    outside = world(ffd, index[((index < 1) | (index > last)).any(axis=1)])
    assert np.array_equal(ffd(outside), Affine(affine)(outside))


def test_refined_on_the_same_domain(random):
    ffd = lattice()
    fine = ffd.refined()
    assert fine.shape == tuple(2 * (n - 3) + 3 for n in ffd.shape)
    index = random.uniform(0, np.array(ffd.shape) - 1, (500, 3))
    points = world(ffd, index[(np.abs(index - np.round(index)) > 1e-9).all(axis=1)])
    assert np.abs(fine(points) - ffd(points)).max() < 1e-14


def test_three_control_points_surround_nothing():
    with pytest.raises(InvalidDeformer, match="four control points"):
        lattice((6, 3, 6))
