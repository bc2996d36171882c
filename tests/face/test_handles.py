"""Handles of a face satisfy the laws of deformers, and move what their names say."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidDeformer, InvalidParameter
from pliant.face.dense import subdivided_mean
from pliant.face.expressions import EXPRESSIONS, expression, expression_fields
from pliant.face.features import GROUPS, HANDLES, handles_of, sites
from pliant.face.topology import mean_face, mirrored
from pliant.testing import check_deformer


@pytest.fixture(scope="module")
def handles():
    return pl.FaceHandles(mean_face().points)


def test_handles_satisfy_the_laws_of_deformers(handles, random):
    away = handles.moved(handles.rest + random.normal(0, 0.02, handles.rest.shape))
    check_deformer(away, mean_face().points[::5] + random.normal(0, 0.3, (94, 3)))
    check_deformer(away, mean_face(), smooth=lambda points: np.zeros(len(points), bool))  # no derivative at sites


def test_every_group_is_made_of_handles_and_every_site_is_moved_wholly():
    chosen, parts = sites()
    assert sorted(HANDLES) == sorted(name for names in GROUPS.values() for name in names)
    assert np.allclose(parts.sum(axis=1), 1)
    assert (parts >= 0).all()
    assert (parts.sum(axis=0) > 0).all()
    assert len(np.unique(chosen)) == len(chosen)


def test_a_handle_takes_its_landmarks_along(handles):
    chosen, parts = sites()
    for name in ("chin", "nose tip", "left cheek"):
        moved = handles.shifted({name: (0.1, -0.2, 0.3)})(mean_face().points) - mean_face().points
        alone = chosen[parts[:, HANDLES.index(name)] == 1]
        assert np.allclose(moved[alone], [0.1, -0.2, 0.3], atol=1e-9)
        others = chosen[parts[:, HANDLES.index(name)] == 0]
        assert np.abs(moved[others]).max() < 1e-9


def test_all_handles_together_move_the_face(handles):
    moved = handles.shifted(dict.fromkeys(GROUPS, (0.2, 0.1, -0.3)))(mean_face().points)
    inside = sites()[0]
    assert np.allclose(moved[inside] - mean_face().points[inside], [0.2, 0.1, -0.3], atol=1e-9)


def test_a_group_is_all_of_its_handles(handles):
    one = handles.shifted({"brows": (0, 0.3, 0)})
    many = handles.shifted(dict.fromkeys(GROUPS["brows"], (0, 0.3, 0)))
    assert np.array_equal(one.controls, many.controls)
    assert handles_of("brows") == [HANDLES.index(name) for name in GROUPS["brows"]]


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_expressions_are_symmetric_and_do_not_fold(handles, name):
    moved = handles.moved(handles.rest + expression(name))
    points = moved(mean_face().points)
    assert np.allclose(mirrored(points), points, atol=1e-9)
    between = subdivided_mean(1).points[468:]  # the plain form has no derivative at its sites
    assert pl.volume_ratio(moved, between).min() > 0
    at = list(EXPRESSIONS).index(name)
    assert np.allclose(points - mean_face().points, expression_fields()[at], atol=1e-9)


def test_expressions_do_what_they_are_called(handles):
    def after(name):
        return handles.moved(handles.rest + expression(name))(mean_face().points) - mean_face().points

    smile = after("smile")
    assert (smile[[61, 291], 1] > 0.5).all()
    assert smile[61, 0] < 0 < smile[291, 0]
    opened = mean_face().points + after("open mouth")
    assert opened[13, 1] - opened[14, 1] > 1
    lids = mean_face().points + after("closed eyes")
    gap = (lids[159] - lids[145])[1]
    assert 0 < gap < 0.4 * (mean_face().points[159] - mean_face().points[145])[1]
    assert after("raised brows")[105, 1] > 0.5


def test_bad_input_is_named():
    with pytest.raises(InvalidParameter, match=r"no part of a face is called 'ears'.*nose tip"):
        pl.FaceHandles(mean_face().points).shifted({"ears": (0, 0, 1)})
    with pytest.raises(InvalidParameter, match=r"no expression is called 'grin'.*smile"):
        expression("grin")
    with pytest.raises(InvalidDeformer, match="468"):
        pl.FaceHandles(np.zeros((10, 3)))
    with pytest.raises(InvalidDeformer, match="displacements"):
        pl.FaceHandles(mean_face().points, np.zeros((3, 3)))
