"""Work over chunks."""

import threading

import numpy as np
import pytest

from pliant.numerics.compute.chunks import for_chunks


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 95])
def test_every_place_is_visited_once_in_pieces_no_larger_than_a_chunk(count):
    visits, sizes = np.zeros(count, int), []

    def work(start, stop):
        visits[start:stop] += 1
        sizes.append(stop - start)

    for_chunks(work, count, 10)
    assert (visits == 1).all()
    assert max(sizes, default=0) <= 10


def test_work_that_starts_work_does_not_wait_for_itself():
    total, lock = [], threading.Lock()

    def inner(start, stop):
        with lock:
            total.append(stop - start)

    ended = threading.Thread(target=for_chunks, args=(lambda *_: for_chunks(inner, 50, 10), 40, 10), daemon=True)
    ended.start()
    ended.join(30)
    assert not ended.is_alive()
    assert sum(total) == 200


def test_an_error_reaches_the_caller():
    def work(start, _stop):
        raise ArithmeticError(str(start))

    with pytest.raises(ArithmeticError):
        for_chunks(work, 30, 10)
