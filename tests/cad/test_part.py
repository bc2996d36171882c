"""Parts: exact images within the tolerance, valid solids, smooth joins that stay smooth."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_BSplineSurface

import pliant as pl
from pliant.cad import Part
from pliant.cad.kernel import parts_of
from pliant.errors import InvalidParameter, InvalidTarget, NotConverged

TWIST = pl.Twist(axis="z", angle=np.pi / 3, bounds=(0, 60))


def samples(part, count=9):
    """(m, 3) points of all faces, at the same parameters for parts of the same topology."""
    found = []
    for face in parts_of(part.shape, "face"):
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        surface = BRep_Tool.Surface_s(face)
        for u in np.linspace(u0, u1, count):
            for v in np.linspace(v0, v1, count):
                point = surface.Value(u, v)
                found.append((point.X(), point.Y(), point.Z()))
    return np.array(found)


@pytest.fixture(scope="module")
def twisted(bracket):
    return bracket.deformed(TWIST, tolerance=1e-3)


def test_surfaces_are_the_images_within_the_tolerance(bracket, twisted):
    off = np.linalg.norm(samples(twisted) - TWIST(samples(bracket)), axis=1)
    assert off.max() < 1e-3
    assert all(isinstance(BRep_Tool.Surface_s(face), Geom_BSplineSurface) for face in parts_of(twisted.shape, "face"))


def test_a_valid_solid_of_the_right_volume(bracket, twisted):
    assert bracket.valid
    assert twisted.valid
    assert twisted.gap < 3e-3
    assert twisted.volume == pytest.approx(bracket.volume, rel=2e-5)  # a twist keeps it
    assert repr(twisted) == repr(bracket) == "Part(1 solids, 27 faces, 59 edges)"


def test_smooth_joins_stay_smooth(bracket, twisted):
    smooth = bracket.kinks < 1e-6
    assert smooth.sum() > 40
    assert twisted.kinks[smooth].max() <= 1e-3  # radians
    assert (bracket.kinks > 1).sum() == 2  # the rims of the bore
    assert (twisted.kinks > 0.5).sum() == 2


def test_coarse_surfaces_may_meet_smoothly_all_the_same(bracket):
    coarse = bracket.deformed(TWIST, tolerance=0.05, angle=1.0)
    off = np.linalg.norm(samples(coarse) - TWIST(samples(bracket)), axis=1).max()
    assert 1e-3 < off < 0.05
    smooth = bracket.kinks < 1e-6
    assert coarse.kinks[smooth].max() > 5e-3
    asked = bracket.deformed(TWIST, tolerance=0.05, angle=2e-3)
    assert asked.kinks[smooth].max() <= 2e-3
    assert asked.valid


def test_what_cannot_be_smooth_is_said(bracket):
    with pytest.raises(NotConverged, match="met smoothly"):
        bracket.deformed(pl.Taper(axis="z", factor=0.2, bounds=(20, 40)), tolerance=5.0)


@pytest.mark.parametrize(
    "solid", [BRepPrimAPI_MakeSphere(10.0), BRepPrimAPI_MakeCone(10.0, 0.0, 20.0), BRepPrimAPI_MakeTorus(10.0, 3.0)]
)
def test_seams_and_poles(solid):
    part = Part(solid.Shape())
    affine = pl.Affine(np.array([[1, 0.2, 0, 1], [0, 1.5, 0.1, 2], [0, 0, 0.8, 3], [0, 0, 0, 1]]))
    moved = part.deformed(affine, tolerance=1e-3)
    assert moved.valid
    assert moved.volume == pytest.approx(1.5 * 0.8 * part.volume, rel=1e-4)


def test_mirrors_turn_a_part_right_side_out(bracket):
    mirrored = bracket.deformed(pl.Affine.scaling((-1, 1, 1)), tolerance=1e-2)
    assert mirrored.valid
    assert mirrored.volume == pytest.approx(bracket.volume, rel=1e-3)


def test_stacks_and_lattices(bracket):
    ffd = pl.BSplineFFD.around(bracket.mesh(), shape=(4, 4, 5))
    moved = ffd.moved(ffd.rest + np.random.default_rng(1).normal(size=ffd.rest.shape))
    stack = pl.Stack([pl.Layer("ffd", moved), pl.Layer("twist", TWIST, envelope=0.5)])
    part = bracket.deformed(stack, tolerance=1e-2)
    assert part.valid
    assert np.linalg.norm(samples(part) - stack(samples(bracket)), axis=1).max() < 1e-2


def test_meshes_of_parts_are_closed_and_outwards(bracket):
    mesh = bracket.mesh(1e-4)
    assert pl.volume(mesh) == pytest.approx(bracket.volume, rel=1e-3)


def test_what_no_part_takes(bracket):
    with pytest.raises(InvalidTarget, match="no map of space"):
        bracket.deformed(pl.LaplacianEdit(np.arange(4), np.array([1])))
    with pytest.raises(InvalidParameter, match="positive"):
        bracket.deformed(TWIST, tolerance=0)
    with pytest.raises(InvalidParameter, match="radians"):
        bracket.deformed(TWIST, angle=0)
    with pytest.raises(NotConverged, match="spans"):
        bracket.deformed(pl.Sine(axis="z", amplitude=1.0, waves=5000.0, bounds=(0, 60)), tolerance=1e-6)
