"""Orientations: axes and quaternions are inverse to each other and agree with the NIfTI formulas."""

from __future__ import annotations

import nibabel as nib
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pliant.numerics.rigid.quaternions import axes_of, quaternion_of, rounded_quaternion


@st.composite
def frames(draw):
    """Orthonormal frames of either hand, among them half turns."""
    numbers = draw(st.lists(st.floats(-1, 1), min_size=4, max_size=4))
    quaternion = np.array(numbers)
    if draw(st.booleans()):
        quaternion[0] = 0.0
    if np.linalg.norm(quaternion) < 1e-3:
        quaternion = np.array([1.0, 0, 0, 0])
    quaternion /= np.linalg.norm(quaternion)
    axes = nib.quaternions.quat2mat(quaternion)
    return axes * [1, 1, draw(st.sampled_from([1, -1]))]


@settings(deadline=None, max_examples=100)
@given(frames())
def test_axes_survive_the_quaternion(axes):
    qfac, bcd = quaternion_of(axes)
    # b, c, d determine a = sqrt(1 - ...) to half the digits only, and NIfTI takes a for 0 where a^2 < 1e-7
    allowed = 2.1e-7**0.5 * 2 if 1 - bcd @ bcd < 2e-7 else 3e-7
    assert np.abs(axes_of(qfac, bcd) - axes).max() < allowed


@settings(deadline=None, max_examples=60)
@given(frames())
def test_six_decimals_cost_less_than_their_neighbours(axes):
    qfac, bcd = rounded_quaternion(axes, 6)
    assert (np.round(bcd, 6) == bcd).all()
    naive = axes_of(qfac, np.round(quaternion_of(axes)[1], 6))
    assert np.abs(axes_of(qfac, bcd) - axes).max() <= np.abs(naive - axes).max()


@settings(deadline=None, max_examples=60)
@given(frames())
def test_agrees_with_the_qform_of_nifti(axes):
    header = nib.Nifti1Header()
    affine = np.eye(4)
    affine[:3, :3] = axes
    header.set_qform(affine, code=1)
    bcd = np.array([header[f"quatern_{name}"] for name in "bcd"], np.float64)
    ours = axes_of(float(header["pixdim"][0]), bcd)
    bound = 1e-6 if 1 - (bcd**2).sum() > 1e-3 else 2e-3  # near half turns the root of a rounding error is what is left
    assert np.abs(ours - header.get_qform()[:3, :3]).max() < bound


@pytest.mark.parametrize("bcd", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0.8, 0), (1, 1e-4, 0)])
@pytest.mark.parametrize("qfac", [1.0, -1.0])
def test_axes_are_orthonormal_and_of_the_named_hand(qfac, bcd):
    axes = axes_of(qfac, np.array(bcd, np.float64))
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.isclose(np.linalg.det(axes), qfac)
