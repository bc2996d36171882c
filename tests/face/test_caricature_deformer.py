"""The caricature as a deformer: the laws of deformers, and the same faces as the function's."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidDeformer
from pliant.face.features import GROUPS, group_of_sites, sites
from pliant.face.topology import mean_face
from pliant.testing import check_deformer


def test_it_satisfies_the_laws_of_deformers(face, random):
    away = pl.FaceCaricature(face.landmarks, 0.6, nose=1.4, mouth=0.5, expression=0.3)
    places = face.landmarks[::5] + random.normal(0, 0.3, (94, 3))
    check_deformer(away, places)
    check_deformer(away, face.mesh, smooth=lambda points: np.zeros(len(points), bool))


@pytest.mark.parametrize(("amount", "groups"), [(0.5, {}), (-0.4, {"nose": 1.5}), (0.4, {"eyes": 0.0, "chin": 1.8})])
def test_it_makes_the_same_face_as_the_function(face, amount, groups):
    expected = pl.caricature(face, amount, groups)
    assert expected.amount == amount  # nothing folds
    made = pl.FaceCaricature(face.landmarks, amount, **groups)
    np.testing.assert_allclose(made(face.mesh).points, expected.face.mesh.points, atol=1e-12)
    places = face.landmarks + 0.2
    np.testing.assert_allclose(made.jacobian(places), expected.deformer.jacobian(places), atol=1e-9)


def test_minus_one_is_the_mean_face_with_the_expression_of_the_face(face):
    mean = pl.FaceCaricature(face.landmarks, -1.0)(face.landmarks)
    from pliant.face.identity import difference_from_mean

    chosen = sites()[0]
    expected = mean_face().points + difference_from_mean(face.landmarks).expression
    np.testing.assert_allclose(mean[chosen], expected[chosen], atol=1e-9)


def test_a_feature_alone_moves_its_own_landmarks(face):
    chosen, parts = sites()[0], group_of_sites()
    for number, name in enumerate(GROUPS):
        alone = dict.fromkeys(GROUPS, 0.0) | {name: 1.0}
        moved = pl.FaceCaricature(face.landmarks, 1.0, **alone)(face.landmarks) - face.landmarks
        assert np.abs(moved[chosen[parts[:, number] == 0]]).max() < 1e-9
        assert np.abs(moved[chosen[parts[:, number] == 1]]).max() > 0.01


def test_it_is_kept_in_projects_and_has_keys_in_time(face, tmp_path):
    layer = pl.Layer("caricature", pl.FaceCaricature(face.landmarks, 0.7, nose=1.3))
    bare = pl.PolygonMesh(face.mesh.points, face.mesh.faces)
    scene = pl.Scene(bare, pl.Stack([layer]))
    pl.save_project(scene, tmp_path / "face.pliant")
    again = pl.load_project(tmp_path / "face.pliant")
    np.testing.assert_array_equal(again.deformed().points, scene.deformed().points)
    clip = pl.Clip(bare, scene.stack, duration=1.0).key("caricature", 0.0, {"amount": 0.0})
    clip = clip.key("caricature", 1.0, {"amount": 1.0})
    half = pl.FaceCaricature(face.landmarks, 0.5, nose=1.3)(bare).points
    np.testing.assert_allclose(clip.sample(0.5).points, half, atol=1e-9)


def test_what_is_no_face_is_refused():
    with pytest.raises(InvalidDeformer, match="468"):
        pl.FaceCaricature(np.zeros((5, 3)))
    with pytest.raises(InvalidDeformer, match="nose is nan"):
        pl.FaceCaricature(mean_face().points, nose=np.nan)
