"""Saving while being killed and where there is no room: a few of the many that reliability/saving.py tries."""

from __future__ import annotations

import random

import pytest

from reliability.saver import NAMES
from reliability.saving import fill_once, kill_once


@pytest.mark.parametrize("name", ["a.pliant", "a.obj"])
def test_killed_while_saving_the_old_or_the_new_file_is_there(name, tmp_path):
    assert kill_once(name, tmp_path, random.Random(1))["outcome"] in ("old", "new")


@pytest.mark.parametrize("name", NAMES)
def test_without_room_the_old_file_stays_and_nothing_beside_it(name, tmp_path):
    found = fill_once(name, tmp_path, random.Random(2))
    assert found["full"] == "kept", found
