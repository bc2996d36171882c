"""Flare: the scales at both ends and in the middle, against plain NumPy."""

from __future__ import annotations

import numpy as np
from barr_cases import POINTS, SKEW, bounds, smooth
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.space.axial import AxialDeformer
from pliant.space.flare import Flare
from pliant.space.taper import Taper
from pliant.testing import check_deformer

factors = st.floats(0.3, 2)


def test_obeys_the_laws_of_deformers():
    flare = Flare.around(POINTS, start=1.2, end=0.7, bulge=0.2, **SKEW)
    check_deformer(flare, POINTS, smooth=smooth(flare))


@settings(deadline=None, max_examples=30)
@given(factors, factors, st.floats(-0.1, 0.5), bounds)
def test_is_the_formula_and_its_inverse_is_exact(start, end, bulge, limits):
    flare = Flare(start=start, end=end, bulge=bulge, bounds=limits, axis="x")
    t = np.clip((POINTS[:, 0] - limits[0]) / (limits[1] - limits[0]), 0, 1)
    r = start + (end - start) * t + bulge * (1 - (2 * t - 1) ** 2)
    assert np.allclose(flare(POINTS), POINTS * np.stack([np.ones_like(r), r, r], axis=1), atol=1e-13)
    assert np.allclose(np.linalg.det(flare.jacobian(POINTS)), r**2, atol=1e-12)
    assert np.allclose(flare.inverse(flare(POINTS)), POINTS, atol=1e-12)


def test_without_a_bulge_it_is_a_taper():
    assert np.allclose(Flare(end=0.4)(POINTS), Taper(factor=0.4)(POINTS), atol=1e-14)


def test_the_table_and_the_fused_kernel_agree():
    flare = Flare.around(POINTS, start=1.4, end=0.6, bulge=0.3, **SKEW)
    out = np.empty_like(POINTS)
    AxialDeformer._move(flare, POINTS, out)
    assert np.allclose(flare(POINTS), out, atol=1e-14)
    assert np.allclose(flare.jacobian(POINTS), AxialDeformer.jacobian(flare, POINTS), atol=1e-13)
