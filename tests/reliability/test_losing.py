"""A batch on clusters that lose workers, and that are shut down amidst it."""

from __future__ import annotations

import gc

import pytest

from reliability.losing import figures


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_every_job_has_one_outcome_and_the_bytes_of_a_serial_run():
    found = figures(jobs=24, kills=2)
    gc.collect()  # what killed workers leave is found here, and not in another test
    assert found["jobs with exactly one outcome"] == found["files as of the serial run"] == 24
    assert found["failed outcomes"] == found["files left over"] == 0
    assert found["of them taken over by the next"] >= 12
