"""One BLAS thread, for as long as anybody wants it, whichever threads come and go."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

from threadpoolctl import threadpool_info

from pliant.numerics.compute.one_thread import one_blas_thread


def counts():
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_the_last_to_leave_puts_the_number_back():
    with one_blas_thread():  # the libraries are loaded now
        pass
    before = counts()
    stay = ExitStack()
    with ThreadPoolExecutor(1) as other:
        with one_blas_thread():
            assert counts() == {1}
            other.submit(stay.enter_context, one_blas_thread()).result()
        assert counts() == {1}  # the other thread is still inside
        other.submit(stay.close).result()
        assert counts() == before


def test_a_thread_that_came_second_is_heard_when_it_comes_again():
    with one_blas_thread():
        pass
    before = counts()
    with ThreadPoolExecutor(1) as other, ExitStack() as stay:
        other.submit(stay.enter_context, one_blas_thread()).result()
        assert counts() == {1}
    assert counts() == before
