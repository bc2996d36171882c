"""Angles and logarithms of eight lanes agree with the library's, everywhere."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import kernel
from pliant.numerics.compute.lane_functions import angle, log_ratio
from pliant.numerics.compute.lanes import load, spread, store


@kernel
def angles(sines, cosines, out):
    for n in range(0, len(out), 8):
        store(out, n, angle(load(sines, n), load(cosines, n), spread(0.0)))


@kernel
def logarithms(tops, bottoms, out):
    for n in range(0, len(out), 8):
        store(out, n, log_ratio(load(tops, n), load(bottoms, n)))


def test_angles_agree_with_arctan2():
    random = np.random.default_rng(0)
    sines = 10.0 ** random.uniform(-200, 200, 80_000) * random.uniform(0, 1, 80_000)
    cosines = sines * 10.0 ** random.uniform(-20, 20, 80_000) * random.choice([-1, 1], 80_000)
    out = np.empty(len(sines))
    angles(sines, cosines, out)
    expected = np.arctan2(sines, cosines)
    assert (np.abs(out - expected) <= 1e-15 * expected).all()


def test_angles_of_the_octants():
    sines = np.array([0, 1, 1, 1, 0, 0, 1e-300, 1.0])
    cosines = np.array([1, 1, 0, -1, -1, 0, 1, -1e-300])
    out = np.empty(8)
    angles(sines, cosines, out)
    assert np.allclose(out, [0, np.pi / 4, np.pi / 2, 3 * np.pi / 4, np.pi, 0, 1e-300, np.pi / 2], rtol=3e-16)


def test_logarithms_agree():
    random = np.random.default_rng(0)
    tops, bottoms = 10.0 ** random.uniform(-150, 150, (2, 80_000))
    bottoms[:40_000] = tops[:40_000] * random.uniform(0.25, 4, 40_000)
    out = np.empty(len(tops))
    logarithms(tops, bottoms, out)
    expected = np.log(tops.astype(np.longdouble) / bottoms)
    assert (np.abs(out - expected) <= 1e-15 * np.maximum(np.abs(expected), 0.3)).all()
