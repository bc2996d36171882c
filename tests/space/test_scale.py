"""Scale: a linear deformer of three factors."""

from __future__ import annotations

import numpy as np
import pytest
from barr_cases import POINTS

from pliant.errors import InvalidDeformer, NonFiniteResult
from pliant.numerics.maps.normals import carry_normals
from pliant.space.scale import Scale
from pliant.testing import check_deformer

AXES = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]


def test_obeys_the_laws_of_deformers():
    check_deformer(Scale(x=2, y=0.5, z=3, origin=[1, 2, 3], axes=AXES), POINTS)


def test_is_the_formula_along_any_axes():
    scale = Scale(x=2, y=-0.5, z=3, origin=[1, 2, 3], axes=AXES)
    local = (POINTS - [1, 2, 3]) @ AXES
    assert np.allclose(scale(POINTS), (local * [2, -0.5, 3]) @ AXES.T + [1, 2, 3], atol=1e-13)
    assert np.allclose(np.linalg.det(scale.jacobian(POINTS)), -3)
    assert np.allclose(scale.inverse(scale(POINTS)), POINTS, atol=1e-13)


def test_normals_are_divided_by_the_factors():
    normals = np.random.default_rng(1).normal(size=POINTS.shape)
    expected = normals / [2, 3, 4]
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(carry_normals(Scale(x=2, y=3, z=4).jacobian(POINTS), normals), expected, atol=1e-14)


def test_the_middle_of_a_shape_stays():
    middle = (POINTS.min(axis=0) + POINTS.max(axis=0)) / 2
    assert np.allclose(Scale.around(POINTS, x=7, z=0.1)(middle[None]), middle)


def test_refusals_name_the_cause():
    with pytest.raises(InvalidDeformer, match="orthonormal"):
        Scale(axes=np.ones((3, 3)))
    with pytest.raises(InvalidDeformer, match="finite"):
        Scale(x=np.nan)
    with pytest.raises(InvalidDeformer, match="flattens"):
        Scale(y=0).inverse(POINTS)
    with pytest.raises(NonFiniteResult):
        Scale(x=1e300)(POINTS * 1e300)
