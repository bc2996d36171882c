"""Random variants: seeded one by one, whoever draws them."""

from __future__ import annotations

import numpy as np
import pytest

import pliant as pl
from pliant.batch.sampling import coefficients
from pliant.errors import InvalidParameter


@pytest.fixture
def field(cohort):
    mesh = pl.read(cohort[0])
    return pl.GaussianProcess(pl.GaussianKernel(sigma=80.0, scale=8.0)).sample(seed=0, domain=mesh, rank=20)


def drawn(field, paths, out, **options):
    return {each.output.name: each for each in pl.batch.sample(field, paths, out / "{stem}-{copy}.ply", **options)}


def test_variants_do_not_depend_on_who_draws_them_nor_on_how_many(field, cohort, tmp_path):
    few = drawn(field, cohort[:2], tmp_path / "a", count=2, seed=7, workers=0)
    more = drawn(field, cohort[:3], tmp_path / "b", count=3, seed=7, workers=2)
    assert len(few) == 4
    assert len(more) == 9
    assert len({each.output.read_bytes() for each in more.values()}) == 9
    for name, each in few.items():
        assert each.output.read_bytes() == more[name].output.read_bytes()


def test_variants_are_the_field_at_coefficients_of_their_own_seed(field, cohort, tmp_path):
    mesh = pl.read(cohort[1])
    found = drawn(field, cohort[:2], tmp_path / "a", count=2, seed=3, amount=0.5, workers=0)
    expected = field.moved(coefficients(field, 3, 1, 1, 0.5))(mesh).points
    assert np.allclose(pl.read(found[f"{cohort[1].stem}-1.ply"].output).points, expected, atol=1e-4)


def test_a_model_moves_meshes_in_correspondence(cohort, tmp_path):
    model = pl.learn_model([pl.read(path) for path in cohort], align=False)
    found = drawn(model, cohort[:1], tmp_path, count=200, seed=1, workers=0)
    assert {each.status for each in found.values()} == {"ok"}
    heights = [np.ptp(pl.read(each.output).points[:, 2]) for each in found.values()]
    examples = [np.ptp(pl.read(path).points[:, 2]) for path in cohort]
    assert np.mean(heights) == pytest.approx(examples[0], abs=4 * np.std(examples) / np.sqrt(200))  # around itself
    assert np.std(heights) == pytest.approx(np.std(examples, ddof=1), rel=0.25)


def test_what_has_no_coefficients(stack, cohort, tmp_path):
    with pytest.raises(InvalidParameter, match="Stack"):
        pl.batch.sample(stack, cohort, tmp_path / "{stem}.ply")


def test_copies_need_names(field, cohort, tmp_path):
    with pytest.raises(InvalidParameter, match="both be written"):
        pl.batch.sample(field, cohort, tmp_path / "{stem}.ply", count=2)
    with pytest.raises(InvalidParameter, match="count"):
        pl.batch.sample(field, cohort, tmp_path / "{stem}.ply", count=0)
