"""The laws of deformers on cases drawn at random, a few of each; where peers do the same thing they agree."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pliant.scene.kinds import all_kinds
from reliability.cases import CASES
from reliability.mathematics import LIMITS, laws
from reliability.peers import PEERS


@pytest.mark.filterwarnings("ignore::pliant.errors.PliantWarning")  # a case may have fewer fields than asked for
@pytest.mark.parametrize("name", CASES)
def test_laws_hold_on_cases_drawn_at_random(name):
    for seed in range(3000, 3002 if name.startswith("face") else 3003):
        found = laws(name, seed)
        assert {law: off for law, off in found.items() if law in LIMITS and off > LIMITS[law]} == {}
        assert any(not math.isnan(found[law]) for law in LIMITS)


@pytest.mark.parametrize("name", [name for name in PEERS if "ARAP" not in name])
def test_peers_agree(name):
    ask, limit, _ = PEERS[name]
    assert max(ask(np.random.default_rng(seed)) for seed in range(3)) <= limit


def test_every_kind_has_cases():
    ours = {name for name, kind in all_kinds().items() if kind.cls.__module__.startswith("pliant.")}
    missing = {kind for kind in ours if not any(name.startswith(kind) for name in CASES)}
    assert missing == set()
