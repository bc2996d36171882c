"""Caricatures go where p + k (p - mean) says, keep the expression, and do not fold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import pliant as pl
from pliant.errors import InvalidParameter
from pliant.face.expressions import EXPRESSIONS, expression_fields
from pliant.face.features import GROUPS, group_of_sites, sites
from pliant.face.identity import difference_from_mean
from pliant.face.topology import mean_face

CHOSEN = sites()[0]


def like(face, landmarks):
    """A face with other landmarks."""
    return replace(face, landmarks=landmarks, mesh=face.mesh.with_points(landmarks))


def test_none_is_the_face_itself(face):
    result = pl.caricature(face, 0.0)
    assert np.allclose(result.face.mesh.points, face.mesh.points, atol=1e-12)
    assert (result.amount, result.least) == (0.0, pytest.approx(1.0))


def test_sites_go_away_from_the_mean(face):
    result = pl.caricature(face, 0.6)
    identity = difference_from_mean(face.landmarks).identity
    assert np.allclose(result.face.landmarks[CHOSEN], (face.landmarks + 0.6 * identity)[CHOSEN], atol=1e-9)
    assert result.amount == result.asked == 0.6
    assert np.array_equal(result.face.mesh.uvs.values, face.mesh.uvs.values)  # the texture rides along
    assert result.face.picture is face.picture


def test_minus_one_is_the_mean_where_the_face_shows_no_expression(face):
    points = mean_face().points * [1.05, 0.97, 1.0]
    gentle = like(face, points)
    everything = pl.caricature(gentle, -1.0, expression=1.0)
    assert np.allclose(everything.face.landmarks[CHOSEN], mean_face().points[CHOSEN], atol=1e-9)


def test_a_group_without_gain_stays_and_one_with_gain_goes_farther(face):
    identity = difference_from_mean(face.landmarks).identity
    gains = {"nose": 1.5, "mouth": 0.0}
    moved = pl.caricature(face, 0.4, gains).face.landmarks - face.landmarks
    parts = group_of_sites() @ [gains.get(name, 1.0) for name in GROUPS]
    assert np.allclose(moved[CHOSEN], 0.4 * parts[:, None] * identity[CHOSEN], atol=1e-9)
    assert np.abs(moved[[13, 14]]).max() < 1e-9
    assert np.linalg.norm(moved[4]) == pytest.approx(0.6 * np.linalg.norm(identity[4]))


@pytest.mark.parametrize("name", ["smile", "open mouth", "kiss", "raised brows"])
def test_an_expression_is_told_from_identity(face, name):
    at = list(EXPRESSIONS).index(name)
    shown = mean_face().points + expression_fields()[at]
    parts = difference_from_mean(shown)
    assert np.allclose(parts.identity + parts.expression, shown - mean_face().points)
    assert parts.strengths[at] == pytest.approx(1.0, abs=0.35)
    assert parts.strengths.argmax() == at
    left = np.sqrt((parts.identity**2).sum(axis=1).mean())
    assert left < 0.4 * np.sqrt((expression_fields()[at] ** 2).sum(axis=1).mean())
    kept = pl.caricature(like(face, shown), 0.8).face.landmarks - shown
    along = pl.caricature(like(face, shown), 0.8, expression=1.0).face.landmarks - shown
    assert np.linalg.norm(kept) < 0.45 * np.linalg.norm(along)  # a smile is not exaggerated unless asked


def test_a_smile_in_the_portrait_is_seen(face):
    strengths = dict(zip(EXPRESSIONS, difference_from_mean(face.landmarks).strengths, strict=True))
    assert strengths["smile"] > 1
    assert strengths["smile"] == max(strengths.values())


@pytest.mark.parametrize("amount", [0.8, 3.0, -1.0])
def test_sites_never_fold_on_the_face(face, amount):
    dense = pl.dense_face(face, 1)
    result = pl.caricature(dense, amount)
    found = pl.volume_ratio(result.deformer, dense.mesh)
    assert found.min() > result.least - 1e-9 > 0
    assert abs(result.amount) <= abs(amount)
    assert ("more would fold" in str(result)) == (result.amount != amount)
    steps = np.linspace(0.05, 1, 20)
    rest, controls = result.deformer.rest, result.deformer.controls
    for step in steps:  # nor on the way there
        assert pl.volume_ratio(result.deformer.moved(rest + step * (controls - rest)), dense.mesh).min() > 0


def test_a_lattice_is_proved_not_to_fold_and_comes_near_the_sites(face):
    one, two = pl.caricature(face, 0.7), pl.caricature(face, 0.7, by="lattice")
    assert two.proved
    assert pl.certify(two.deformer).status == "fold-free"
    assert "proved everywhere" in str(two)
    moved = one.face.landmarks - face.landmarks, two.face.landmarks - face.landmarks
    assert np.linalg.norm(moved[0] - moved[1]) < 0.35 * np.linalg.norm(moved[0])


def test_bad_input_is_named(face):
    with pytest.raises(InvalidParameter, match=r"no feature is called 'ears'.*outline"):
        pl.caricature(face, 0.5, {"ears": 2})
    for wrong in ({"amount": np.nan}, {"amount": 9}, {"groups": {"nose": -8}}, {"expression": np.inf}):
        with pytest.raises(InvalidParameter, match="between -5 and 5"):
            pl.caricature(face, **wrong)
    with pytest.raises(InvalidParameter, match="'sites' or by 'lattice'"):
        pl.caricature(face, 0.5, by="cage")
