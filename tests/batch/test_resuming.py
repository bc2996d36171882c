"""The ledger: a run that was cut off goes on where it was."""

from __future__ import annotations

import itertools
import os

import pliant as pl
from pliant.space.profile import Profile

NAME = "pliant-batch.jsonl"
CURVE = Profile(lambda t: t * t, lambda t: 2 * t)  # functions: no data can hold them


def resumed(*arguments, **options):
    found = list(pl.run_batch(*arguments, resume=True, workers=0, **options))
    assert sorted(each.index for each in found) == list(range(len(found)))
    return {each.index for each in found if each.resumed}


def test_a_run_that_was_cut_off_goes_on(stack, cohort, serial, tmp_path):
    out = tmp_path / "out" / "{stem}.ply"
    run = pl.run_batch(stack, cohort, out, workers=0)
    done = {each.index for each in itertools.islice(run, 5)}
    run.close()
    with (tmp_path / "out" / NAME).open("ab") as ledger:
        ledger.write(b'{"job": "cut off wit')
    assert resumed(stack, cohort, out) == done
    assert resumed(stack, cohort, out) == set(range(12))
    assert {i: (tmp_path / "out" / path.name).read_bytes() for i, path in enumerate(cohort)} == serial


def test_what_has_changed_is_done_again(stack, cohort, tmp_path):
    out = tmp_path / "out" / "{stem}.ply"
    list(pl.run_batch(stack, cohort, out, workers=0))
    (tmp_path / "out" / cohort[0].name).unlink()
    (tmp_path / "out" / cohort[1].name).write_bytes(b"cut")
    os.utime(cohort[2], ns=(0, 0))
    assert resumed(stack, cohort, out) == set(range(3, 12))
    assert resumed(stack.replace("twist", envelope=0.5), cohort, out) == set()
    assert resumed(stack.replace("twist", envelope=0.5).replace("bend", muted=True), cohort, out) == set()


def test_what_failed_is_tried_again(stack, cohort, tmp_path):
    out, good = tmp_path / "out" / "{stem}.ply", cohort[4].read_bytes()
    cohort[4].write_bytes(good[:100])
    states = [each.status for each in pl.run_batch(stack, cohort, out, workers=0)]
    assert states.count("failed") == 1
    assert resumed(stack, cohort, out) == set(range(12)) - {4}
    cohort[4].write_bytes(good)
    assert resumed(stack, cohort, out) == set(range(12)) - {4}
    assert resumed(stack, cohort, out) == set(range(12))


def test_functions_are_never_taken_for_the_same(cohort, tmp_path):
    local = pl.Stack([pl.Layer("profile", pl.Twist(angle=1.0, bounds=(0, 240), profile=CURVE))])
    list(pl.run_batch(local, cohort, tmp_path / "out" / "{stem}.ply", workers=0))
    assert resumed(local, cohort, tmp_path / "out" / "{stem}.ply") == set()
