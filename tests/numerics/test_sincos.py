"""Sine and cosine over lanes, in units of the last place."""

from __future__ import annotations

import numpy as np
import pytest

from pliant.numerics.compute.compiling import kernel
from pliant.numerics.compute.lanes import load, store
from pliant.numerics.compute.sincos import sincos


@kernel
def _sweep(angles, sines, cosines):
    for n in range(0, len(angles), 8):
        sine, cosine = sincos(load(angles, n))
        store(sines, n, sine)
        store(cosines, n, cosine)


def swept(angles):
    sines, cosines = np.empty_like(angles), np.empty_like(angles)
    _sweep(angles, sines, cosines)
    return sines, cosines


@pytest.mark.parametrize("reach", [1e-300, 1e-8, 0.8, 3.2, 50.0, 1e4, 1e6])
def test_two_units_of_the_last_place(reach):
    angles = np.random.default_rng(0).uniform(-reach, reach, 80_000)
    exact = angles.astype(np.longdouble)
    for found, expected in zip(swept(angles), (np.sin(exact), np.cos(exact)), strict=True):
        unit = np.spacing(np.abs(expected.astype(np.float64)))
        assert (np.abs(found - expected) / unit).max() <= 2


def test_near_the_zeros_too():
    quarters = np.arange(-4000, 4000, dtype=np.float64) * (np.pi / 2)
    for nudge in (0.0, 1e-16, -1e-12, 1e-9):
        angles = quarters * (1 + nudge)
        exact = angles.astype(np.longdouble)
        for found, expected in zip(swept(angles), (np.sin(exact), np.cos(exact)), strict=True):
            true = expected.astype(np.float64)
            assert np.abs(found - true).max() <= 3e-16
            assert np.allclose(found, true, rtol=1e-9 if nudge == 0.0 else 1e-12, atol=0) or np.abs(true).min() < 1e-16


def test_zero_is_exact():
    sines, cosines = swept(np.zeros(8))
    assert (sines == 0).all()
    assert (cosines == 1).all()
    assert not np.signbit(swept(np.full(8, 0.0))[0]).any()
