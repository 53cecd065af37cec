"""Threads on all cores, each with linear algebra of its own: poses are shared out, not the matrices of one."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from threading import Lock

_is_limited = Lock()


def cores() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def workers(threads: int | None = None) -> Iterator[ThreadPoolExecutor]:
    """Threads on all cores this process may use, each with linear algebra of one thread.

    That limit is one of the whole process. Of several sweeps at once the first sets it and lifts it again when it ends;
    those that last longer go on with more threads than there are cores: slower, with the same results.
    """
    with _single_threaded(), ThreadPoolExecutor(threads or cores()) as pool:
        try:
            yield pool
        except BaseException:  # an interruption among them: what has not begun is dropped
            pool.shutdown(wait=False, cancel_futures=True)
            raise


@contextmanager
def _single_threaded() -> Iterator[None]:
    """One thread for linear algebra, set and lifted by the first who comes; whoever comes meanwhile leaves it alone."""
    from threadpoolctl import threadpool_limits

    if not _is_limited.acquire(blocking=False):
        yield
        return
    try:
        with threadpool_limits(1, user_api="blas"):
            yield
    finally:
        _is_limited.release()
