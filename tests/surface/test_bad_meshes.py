"""Whatever the mesh: a finite result, or an error that says why. Never NaN, never a crash, never a moved outside."""

from __future__ import annotations

import numpy as np
import pytest
from bad_meshes import FLAWS, bad_meshes, flawed
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_shapes import tube, two_legs

from pliant.errors import InvalidControls, InvalidDeformer, InvalidMesh, InvalidParameter, InvalidTarget, PliantError
from pliant.mesh import PolygonMesh
from pliant.surface.arap import ARAP
from pliant.surface.contour_skeletons import contour_skeleton
from pliant.surface.laplacian_edit import LaplacianEdit
from pliant.surface.skeleton_edit import SkeletonEdit
from pliant.surface.smoothing import METHODS, smooth
from pliant.surface.transfer import DeformationTransfer

KINDS = {
    "biharmonic": lambda roi, handle: LaplacianEdit(roi, handle),
    "intrinsic": lambda roi, handle: LaplacianEdit(roi, handle, weights="intrinsic"),
    "naive": lambda roi, handle: LaplacianEdit(roi, handle, method="naive"),
    "similarity": lambda roi, handle: LaplacianEdit(roi, handle, method="similarity"),
    "arap": lambda roi, handle: ARAP(roi, handle, iterations=20),
    "smooth arap": lambda roi, handle: ARAP(roi, handle, smoothness=0.02, iterations=20),
    "skeleton": lambda roi, handle: SkeletonEdit(roi, handle, contours=8),
    "rigid skeleton": lambda roi, handle: SkeletonEdit(roi, handle, contours=8, finish="rigid", iterations=4),
}


def edited(kind, mesh, roi, handle, shift):
    """The result, checked; None where it was refused with a reason."""
    try:
        bound = KINDS[kind](roi, handle).bind(mesh)
        points = bound.deform(bound.rest + shift)
    except PliantError as error:
        if not str(error):
            raise
        return None
    assert np.isfinite(points).all()
    outside = np.setdiff1d(np.arange(len(mesh.points)), roi)
    assert np.array_equal(points[outside], mesh.points[outside])
    return points


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25, deadline=None)
@given(mesh=bad_meshes(), seed=st.integers(0, 1000))
def test_edits_of_bad_meshes_are_finite_or_refused(kind, mesh, seed):
    random = np.random.default_rng(seed)
    center = mesh.points[random.integers(len(mesh.points))]
    away = np.linalg.norm(mesh.points - center, axis=1)
    roi, handle = np.flatnonzero(away < 0.6 * mesh.diagonal), np.flatnonzero(away < 0.1 * mesh.diagonal)
    edited(kind, mesh, roi, handle, random.normal(size=3) * 0.2 * mesh.diagonal)


@pytest.mark.parametrize("kind", [name for name in KINDS if "skeleton" not in name])
@pytest.mark.parametrize("flaw", FLAWS)
def test_a_flaw_inside_the_region_is_no_reason_to_refuse(kind, flaw):
    mesh = flawed(tube(16, 10), flaw, np.random.default_rng(3))
    height = mesh.points[:, 2]
    used = np.unique(mesh.triangles)
    roi = np.flatnonzero((height > 0.8) & (mesh.points[:, 0] < 3))
    handle = np.intersect1d(np.flatnonzero((height > 3.3) & (mesh.points[:, 0] < 3)), used)
    assert edited(kind, mesh, roi, handle, [0.3, 0, 0.1]) is not None


@settings(max_examples=25, deadline=None)
@given(mesh=bad_meshes(), method=st.sampled_from(METHODS))
def test_smoothing_is_finite(mesh, method):
    result = smooth(mesh, 3, method=method, rest=mesh if method == "delta mush" else None)
    assert np.isfinite(result.points).all()
    unused = np.setdiff1d(np.arange(len(mesh.points)), mesh.triangles)
    assert np.array_equal(result.points[unused], mesh.points[unused])


@settings(max_examples=25, deadline=None)
@given(mesh=bad_meshes())
def test_skeletons_group_every_used_vertex(mesh):
    skeleton = contour_skeleton(mesh, 6)
    assert np.isfinite(skeleton.points).all()
    assert set(np.unique(skeleton.groups[mesh.triangles])) == set(range(len(skeleton.points)))
    unused = np.setdiff1d(np.arange(len(mesh.points)), mesh.triangles)
    assert (skeleton.groups[unused] == -1).all()


@settings(max_examples=12, deadline=None)
@given(source=bad_meshes(), target=bad_meshes(), seed=st.integers(0, 100))
def test_transfer_between_bad_meshes_is_finite_and_exact_at_rest(source, target, seed):
    random = np.random.default_rng(seed)
    used = [np.unique(mesh.triangles) for mesh in (source, target)]
    markers = np.column_stack([random.choice(u, 6, replace=False) for u in used])
    clone = DeformationTransfer(source, target, markers)
    assert np.abs(clone.points(source.points) - target.points).max() < 1e-9 * target.diagonal
    assert np.isfinite(clone.points(source.points * [1.1, 0.9, 1.0] + 0.1)).all()


MESH = tube()
TOP = np.flatnonzero(MESH.points[:, 2] > 3)


@pytest.mark.parametrize("kind", KINDS)
def test_every_cause_is_named_before_solving(kind):
    make, count = KINDS[kind], len(MESH.points)
    with pytest.raises(InvalidTarget, match="needs a mesh"):
        make(TOP, TOP[:3]).bind(MESH.points)
    with pytest.raises(InvalidMesh, match="no triangle"):
        make([0, 1], [0]).bind(PolygonMesh(np.zeros((2, 3))))
    with pytest.raises(InvalidDeformer, match="handle is empty"):
        make(TOP, []).bind(MESH)
    with pytest.raises(InvalidDeformer, match=r"outside the region.*vertex 0"):
        make(TOP, [0]).bind(MESH)
    with pytest.raises(InvalidTarget, match=f"vertex {count}; the mesh has {count}"):
        make([*TOP, count], TOP[:1]).bind(MESH)
    with pytest.raises(InvalidDeformer, match="vertex -1: indices count from 0"):
        make([-1], [-1])
    with pytest.raises(InvalidDeformer, match="twice"):
        make(TOP, [TOP[0], TOP[1], TOP[0]])
    with pytest.raises(InvalidDeformer, match="one truth value"):
        make(TOP.astype(float), TOP)
    with pytest.raises(InvalidTarget, match="mask of 3"):
        make(np.ones(3, bool), TOP[:1]).bind(MESH)
    with pytest.raises(InvalidControls, match="finite"):
        make(TOP, TOP[:1]).moved([[np.nan, 0, 0]])
    with pytest.raises(InvalidControls, match="shape"):
        make(TOP, TOP[:2]).moved([[0, 0, 0]])
    with pytest.raises(InvalidControls, match="at rest"):
        _ = make(TOP, TOP[:1]).controls
    with pytest.raises(InvalidTarget, match="ask the binding"):
        _ = make(TOP, TOP[:1]).rest


@pytest.mark.parametrize("kind", KINDS)
def test_a_component_that_nothing_ties_down_is_named(kind):
    mesh = two_legs()
    first = int(np.flatnonzero(mesh.points[:, 0] > 2)[0])
    with pytest.raises(InvalidDeformer, match=rf"component of vertex {first} \(218 vertices\).*nothing ties it down"):
        KINDS[kind](np.arange(len(mesh.points)), [0]).bind(mesh)


@pytest.mark.parametrize("kind", [name for name in KINDS if "skeleton" not in name])
def test_the_region_may_be_everything(kind):
    points = edited(kind, MESH, np.arange(len(MESH.points)), np.arange(8), [1.0, 2.0, 3.0])
    assert np.abs(points - MESH.points - [1, 2, 3]).max() < 1e-6  # nothing holds it back: all goes along


def test_a_skeleton_needs_an_edge():
    with pytest.raises(InvalidDeformer, match="no fixed edge"):
        SkeletonEdit(np.arange(len(MESH.points)), [0]).bind(MESH)


@pytest.mark.parametrize(
    ("markers", "cause"),
    [
        ([[0, 10**6]], "marker 0 uses target vertex 1000000; the target has"),
        ([[-1, 0]], "marker 0 uses source vertex -1"),
        ([[0, 1], [0, 2]], "source vertex 0 is marked twice"),
        ([[0.5, 1]], "vertex indices are needed"),
        ([], "vertex indices are needed"),
    ],
)
def test_wrong_markers_are_named(markers, cause):
    with pytest.raises(InvalidParameter, match=cause):
        DeformationTransfer(MESH, MESH, markers)
