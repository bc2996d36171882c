"""Batches: what they write, what they refuse, and what one bad mesh costs."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pliant as pl
from pliant.batch.naming import output_paths
from pliant.errors import InvalidParameter, UnwritableFile
from pliant.space.profile import Profile

CURVE = Profile(lambda t: t * t, lambda t: 2 * t)  # lambdas cannot be pickled


def written(outcomes):
    assert len({each.index for each in outcomes}) == len(outcomes)
    assert all(each.status == "ok" for each in outcomes), [each.error for each in outcomes]
    return {each.index: each.output.read_bytes() for each in outcomes}


def test_outputs_are_what_the_stack_makes_of_each_mesh(stack, cohort, tmp_path):
    for outcome in pl.run_batch(stack, cohort, tmp_path / "out" / "{stem}-warped{suffix}", workers=0):
        assert outcome.output == tmp_path / "out" / f"{cohort[outcome.index].stem}-warped.ply"
        assert np.array_equal(pl.read(outcome.output).points, stack(pl.read(cohort[outcome.index])).points)


@pytest.mark.parametrize("kind", ["processes", "threads"])
def test_executors_write_the_same_bytes(stack, cohort, serial, tmp_path, kind):
    with ThreadPoolExecutor(3) as threads:
        who = {"workers": 2} if kind == "processes" else {"executor": threads}
        assert written(list(pl.run_batch(stack, cohort, tmp_path / "out" / "{stem}.ply", **who))) == serial


def test_a_bad_mesh_is_a_failed_outcome(stack, cohort, tmp_path):
    cohort[3].write_bytes(cohort[3].read_bytes()[:-40])
    cohort[7].unlink()
    found = {each.index: each for each in pl.run_batch(stack, cohort, tmp_path / "out" / "{stem}.ply", workers=0)}
    assert len(found) == len(cohort)
    assert [i for i, each in found.items() if each.status == "failed"] == [3, 7]
    assert str(cohort[3]) in found[3].error
    assert not found[7].output.exists()


def test_a_deformer_that_breaks_is_a_failed_outcome(cohort, tmp_path):
    mask = np.ones(5)
    stack = pl.Stack([pl.Layer("short", pl.Twist(angle=1.0, bounds=(0, 1)), mask)])
    (outcome,) = pl.run_batch(stack, cohort[:1], tmp_path / "{index}.ply")
    assert outcome.kind == "InvalidTarget"
    assert "mask" in outcome.error


def test_large_plans_travel_in_a_file_that_is_removed(cohort, tmp_path):
    ffd = pl.BSplineFFD.around(pl.read(cohort[0]), shape=(14, 14, 14))
    moved = ffd.moved(ffd.rest + 0.5)
    for outcome in pl.run_batch(moved, cohort[:3], tmp_path / "out" / "{stem}.ply", workers=1):
        assert np.array_equal(
            pl.read(outcome.output).points, pl.Stack([pl.Layer("a", moved)])(pl.read(outcome.input)).points
        )
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir()) == [".jsonl", ".ply", ".ply", ".ply"]


def test_controls_for_each_path(cohort, tmp_path):
    ffd = pl.BSplineFFD.around(pl.read(cohort[0]), shape=(4, 4, 4))
    controls = [ffd.rest + np.random.default_rng(i).normal(size=ffd.rest.shape) for i in range(4)]
    run = pl.run_batch(ffd, [cohort[0]] * 4, tmp_path / "{stem}-{index:03d}.ply", controls=controls, workers=0)
    for outcome in run:
        expected = ffd.moved(controls[outcome.index])(pl.read(cohort[0])).points
        assert np.allclose(pl.read(outcome.output).points, expected, atol=1e-4)  # the file holds float32


def test_recipes_are_laid_around_each_mesh(cohort, tmp_path):
    path = tmp_path / "recipe.toml"
    path.write_text('[[layer]]\nname = "turn"\nkind = "twist"\naround = true\naxis = "z"\nangle = 40\n')
    recipe = pl.read_recipe(path)
    for outcome in pl.run_batch(recipe, cohort[:3], tmp_path / "out" / "{stem}.ply", intensity=0.5, workers=0):
        mesh = pl.read(outcome.input)
        assert np.array_equal(pl.read(outcome.output).points, pl.read(outcome.output).points)
        expected = recipe.stack(mesh, intensity=0.5)(mesh).points
        assert np.allclose(pl.read(outcome.output).points, expected, atol=1e-4)


def test_colliding_outputs_are_refused_before_anything_runs(stack, cohort, tmp_path):
    other = tmp_path / "other" / cohort[5].name
    other.parent.mkdir()
    other.write_bytes(cohort[5].read_bytes())
    with pytest.raises(InvalidParameter, match=r"would both be written .*index"):
        pl.run_batch(stack, [*cohort, other], tmp_path / "out" / "{stem}.ply")
    with pytest.raises(InvalidParameter, match="overwritten"):
        pl.run_batch(stack, cohort, tmp_path / "cohort" / "{stem}{suffix}")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "pattern", ["{name}.ply", "{stem!r}.ply", "{}.ply", "{stem.__class__}.ply", "{stem", "{index:q}"]
)
def test_patterns_that_are_not_understood(pattern, tmp_path):
    with pytest.raises(InvalidParameter, match="pattern"):
        output_paths(pattern, [tmp_path / "a.ply"])


def test_compressed_files_keep_both_endings(tmp_path):
    (path,) = output_paths(tmp_path / "{stem}-x{suffix}", [tmp_path / "in" / "a.b.ply.gz"])
    assert path.name == "a.b-x.ply.gz"


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        ({"workers": -1}, "number of workers"),
        ({"executor": object()}, "no executor"),
        ({"controls": [None]}, "1 controls for 12 paths"),
        ({"deformation": "twist"}, "read_recipe"),
        ({"executor": ThreadPoolExecutor(1), "workers": 2}, "either"),
    ],
)
def test_what_no_batch_takes(stack, cohort, tmp_path, change, cause):
    options = {"deformation": stack, "paths": cohort, "output": tmp_path / "out" / "{stem}.ply", **change}
    with pytest.raises(InvalidParameter, match=cause):
        list(pl.run_batch(**options))


def test_what_cannot_travel_says_so(cohort, tmp_path):
    local = pl.Stack([pl.Layer("profile", pl.Twist(angle=1.0, bounds=(0, 240), profile=CURVE))])
    with pytest.raises(InvalidParameter, match="ThreadPoolExecutor"):
        list(pl.run_batch(local, cohort, tmp_path / "out" / "{stem}.ply", workers=1))


def test_a_ledger_that_cannot_be_written(stack, cohort, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UnwritableFile, match="file"):
        list(pl.run_batch(stack, cohort, tmp_path / "file" / "{stem}.ply"))


def test_an_executor_that_was_shut_down_fails_every_job_once(stack, cohort, tmp_path):
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    found = list(pl.run_batch(stack, cohort, tmp_path / "out" / "{stem}.ply", executor=executor))
    assert sorted(each.index for each in found) == list(range(12))
    assert all(each.status == "failed" and "shutdown" in each.error for each in found)
