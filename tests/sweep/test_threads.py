"""Threads of sweeps: what they limit, and how soon they end when they are interrupted."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import Any

import numpy as np
import pytest
from threadpoolctl import ThreadpoolController, threadpool_limits

import prs_model as prs
from prs_model.sweep.plan import Plan
from prs_model.sweep.quantities import Block
from prs_model.sweep.threads import workers


def _threads() -> set[int]:
    return {each["num_threads"] for each in ThreadpoolController().info() if each["user_api"] == "blas"}


def _elsewhere(what: Callable[[], Any]) -> Any:
    """In a thread that ends: a living one that has set a limit keeps others from it."""
    with ThreadPoolExecutor(1) as other:
        return other.submit(what).result()


def test_two_sweeps_at_once_leave_linear_algebra_as_it_was() -> None:
    """The first to begin ends first."""
    begun, first_is_done = Event(), Event()

    def second() -> None:
        with workers(1):
            begun.set()
            assert first_is_done.wait(60.0)

    limits = _elsewhere(lambda: threadpool_limits(2, user_api="blas"))
    try:
        with ThreadPoolExecutor(1) as other:
            with workers(1) as pool:
                assert pool.submit(_threads).result() == {1}
                there = other.submit(second)
                assert begun.wait(60.0)
            first_is_done.set()
            there.result()
        assert _threads() == {2}
        with workers(1):
            assert _threads() == {1}
        assert _threads() == {2}
    finally:
        _elsewhere(limits.restore_original_limits)


def test_poses_solved_one_by_one_come_in_small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of which only those begun are waited for when a sweep is interrupted."""
    machine = prs.load_machine("hexapod")
    rng = np.random.default_rng(1)
    points = np.array(list(machine.reference_pose.values())) + rng.normal(scale=1e-5, size=(60_000, 6))
    solved: list[int] = []

    def evaluate(plan: Plan, start: int, stop: int) -> Block:
        solved.append(stop - start)
        return {"proof": np.zeros(stop - start, dtype=np.int8)}

    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Plan, "evaluate", evaluate)
    with pytest.raises(KeyboardInterrupt):
        machine.sweep(poses=points, quantities="static_compliance", progress=interrupt)
    assert max(solved) <= 256
