"""Whatever a file of any kind holds, a reader gives something sound or says what is wrong.

The programs in ``reliability/`` do the same for longer, in processes with limits; PLIANT_FUZZ sets the number of tries.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from reliability.mutate import mutants
from reliability.readers import ACCEPTED, FORKED, IN_A_PROCESS, attempt
from reliability.seeds import CORPUS, KINDS, corpus

COUNT = int(os.environ.get("PLIANT_FUZZ", "110"))
SLOW = max(1, COUNT // 100)


@pytest.mark.parametrize("name", corpus())
def test_a_damaged_file_is_read_soundly_or_refused_clearly(name: str, tmp_path: Path) -> None:
    data, others = corpus()[name], list(corpus().values())
    assert attempt(name, data, tmp_path) == ACCEPTED
    begin, count = time.process_time(), SLOW if name.endswith((*IN_A_PROCESS, *FORKED)) else COUNT
    for mutant in mutants(data, others, count, f"test/{name}"):
        attempt(name, mutant, tmp_path)
    assert time.process_time() - begin < 60 + COUNT  # a reader that does not end would hang the run


def test_the_corpus_has_every_kind() -> None:
    assert {path.name for path in CORPUS.iterdir()} == {kind.__name__ for kind in KINDS}
    assert sum(map(len, corpus().values())) < 300_000


def test_the_same_key_makes_the_same_mutants() -> None:
    others = list(corpus().values())
    for name in (
        "meshes/all.obj",
        "meshes/twice.3mf",
        "transforms/a.dof.gz",
        "models/model.h5",
        "projects/kinds.pliant",
    ):
        one, two = (list(mutants(corpus()[name], others, 12, "key")) for _ in range(2))
        assert one == two
        assert one[5:] == list(mutants(corpus()[name], others, 7, "key", 5))
        assert len(set(one)) > 8
