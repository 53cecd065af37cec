"""Time per pose: batch against pose by pose. Run with `pytest -m benchmark -s`."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
import pytest

from prs_model import load_machine


def seconds(run: Callable[[], object], repeats: int = 3) -> float:
    """The best of a few runs."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        run()
        times.append(perf_counter() - start)
    return min(times)


@pytest.mark.benchmark
@pytest.mark.parametrize("name", ["head_3prs", "hexapod"])
def test_batch_against_pose_by_pose(name: str) -> None:
    kinematics = load_machine(name).kinematics
    low, high = np.array(list(kinematics.description.workspace.values())).T
    poses = np.random.default_rng(1).uniform(low, high, (5_000, len(low)))
    some = [dict(zip(kinematics.pose_names, pose, strict=True)) for pose in poses[:100]]
    batch = seconds(lambda: kinematics.newton_batch(poses)) / len(poses)
    single = seconds(lambda: [kinematics.newton(pose) for pose in some]) / len(some)
    ratio = single / batch
    print(f"\n{name}: Newton {1e6 * batch:.1f} us/pose in a batch, {1e6 * single:.0f} us alone, ratio {ratio:.0f}")
    if kinematics.has_closed_form:
        closed = seconds(lambda: kinematics.solve_batch(poses)) / len(poses)
        alone = seconds(lambda: [kinematics.solve(pose) for pose in some]) / len(some)
        print(f"{name}: closed form {1e6 * closed:.1f} us/pose in a batch, {1e6 * alone:.0f} us alone")
        assert closed < batch
    assert 5 * batch < single
