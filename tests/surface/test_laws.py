"""Every surface deformer obeys the laws of deformers."""

import numpy as np
import pytest
from surface_shapes import rotation, tube

from pliant.deformer import LinearBinding
from pliant.surface.arap import ARAP
from pliant.surface.laplacian_edit import LaplacianEdit
from pliant.surface.skeleton_edit import SkeletonEdit
from pliant.testing import check_deformer

MESH = tube(bumps=0.1)
HEIGHT = MESH.points[:, 2]
ROI, HANDLE = np.flatnonzero(HEIGHT > 1.2), np.flatnonzero(HEIGHT > 3.2)
GOAL = (MESH.points[HANDLE] - [0, 0, 1.2]) @ rotation([0.6, 0.2, 0.1]).T + [0.1, 0, 1.2]

DEFORMERS = {
    "biharmonic": LaplacianEdit(ROI, HANDLE),
    "biharmonic intrinsic": LaplacianEdit(ROI, HANDLE, weights="intrinsic"),
    "naive": LaplacianEdit(ROI, HANDLE, method="naive", weights="uniform", pull=2.0),
    "naive mean value": LaplacianEdit(ROI, HANDLE, method="naive", weights="mean value"),
    "similarity": LaplacianEdit(ROI, HANDLE, method="similarity"),
    "arap": ARAP(ROI, HANDLE, tolerance=1e-4),
    "arap smooth": ARAP(ROI, HANDLE, smoothness=0.01, tolerance=1e-5, iterations=2000),
    "skeleton": SkeletonEdit(ROI, HANDLE),
    "skeleton plain": SkeletonEdit(ROI, HANDLE, finish="none", profile=np.ones_like),
    "skeleton links": SkeletonEdit(ROI, HANDLE, finish="none", turning="links", falloff="quadratic"),
    "skeleton rigid": SkeletonEdit(ROI, HANDLE, finish="rigid", iterations=5),
}


@pytest.mark.parametrize("name", DEFORMERS)
def test_it_obeys_the_laws_of_deformers(name):
    check_deformer(DEFORMERS[name].moved(GOAL), MESH)


@pytest.mark.parametrize("name", DEFORMERS)
def test_outside_the_region_nothing_moves_by_a_bit(name):
    points = DEFORMERS[name].moved(GOAL)(MESH).points
    outside = np.setdiff1d(np.arange(len(MESH.points)), ROI)
    assert np.array_equal(points[outside], MESH.points[outside])
    assert np.abs(points[ROI] - MESH.points[ROI]).max() > 0.1


@pytest.mark.parametrize("name", DEFORMERS)
def test_a_mask_says_the_same_as_indices(name):
    from dataclasses import replace

    roi, handle = np.zeros(len(MESH.points), bool), np.zeros(len(MESH.points), bool)
    roi[ROI], handle[HANDLE] = True, True
    masked = replace(DEFORMERS[name], roi=roi, handle=handle).bind(MESH)
    assert np.array_equal(masked.deform(GOAL), DEFORMERS[name].bind(MESH).deform(GOAL))


@pytest.mark.parametrize("name", DEFORMERS)
def test_the_handle_goes_where_it_is_told(name):
    deformer = DEFORMERS[name]
    moved = deformer.bind(MESH).deform(GOAL)[HANDLE]
    if isinstance(deformer, SkeletonEdit):
        assert np.abs(moved.mean(axis=0) - GOAL.mean(axis=0)).max() < 0.05  # as a rigid body about its mean
    elif isinstance(deformer, ARAP) or deformer.method == "biharmonic":
        assert np.array_equal(moved, GOAL)
    else:
        assert np.abs(moved - GOAL).max() < 0.2  # drawn, not held


def test_linear_edits_are_linear_bindings():
    kinds = {name: isinstance(d.bind(MESH), LinearBinding) for name, d in DEFORMERS.items()}
    assert {name for name, linear in kinds.items() if linear} == {
        "biharmonic", "biharmonic intrinsic", "naive", "naive mean value"
    }  # fmt: skip
