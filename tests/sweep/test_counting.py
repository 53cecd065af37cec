"""Modes are counted at every pose: as many as there are, and one that no node shows too."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.exact import Solver
from prs_model.sweep.interpolated import pivots
from prs_model.sweep.interpolated.box_of import shape_of
from prs_model.sweep.interpolated.counting import Counting, counting
from prs_model.sweep.poses import Poses, poses_of
from tests.sweep.nasty import nasty
from tests.verification.gantry import TRAVEL, gantry

LEVEL = (2.0 * np.pi * 231.0) ** 2


@pytest.fixture(scope="module")
def pool() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(2) as workers:
        yield workers


def made(machine: prs.Machine, poses: Poses, level: float, pool: ThreadPoolExecutor) -> Counting:
    return counting(Solver(machine, 1, 0.0), shape_of(machine.kinematics, poses), poses, level, pool)


def below(machine: prs.Machine, poses: Poses, numbers: np.ndarray, level: float) -> list[int]:
    return [
        int((machine.modes(30, **dict(zip(poses.names, pose.tolist(), strict=True))).eigenvalues < level).sum())
        for pose in poses.at(numbers)
    ]


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs")


@pytest.mark.parametrize("hertz", [60.0, 200.0, 280.0, 420.0])
def test_the_count_is_that_of_the_dense_problem_where_it_is_told(
    head: prs.Machine, pool: ThreadPoolExecutor, hertz: float
) -> None:
    """At 60, 200, 280 and 420 Hz modes cross the level within the map."""
    grid = {"nutation": np.linspace(0.0, 0.5, 30), "precession": np.linspace(0.0, 2.0, 40)}
    poses, level = poses_of(head, grid), (2.0 * np.pi * hertz) ** 2
    found = made(head, poses, level, pool)
    assert found.size < 80
    most = found.at_most(poses)(0, poses.size)
    some = np.random.default_rng(15).choice(poses.size, 12, replace=False)
    exact = np.array(below(head, poses, some, level))
    assert (most[some] >= exact).all()
    assert np.mean(most[some] == exact) > 0.7


def test_volumes_lists_and_rigid_joints(pool: ThreadPoolExecutor) -> None:
    machine = prs.load_machine("hexapod")
    points = np.random.default_rng(16).uniform([-3e-3, -3e-3, 0.088], [3e-3, 3e-3, 0.092], size=(900, 3))
    poses = Poses(machine.pose_names, (), np.hstack([points, np.full((900, 3), 0.01)]))
    level = (2.0 * np.pi * 1100.0) ** 2
    found = made(machine, poses, level, pool)
    some = np.arange(0, 900, 150)
    assert found.at_most(poses)(0, 900)[some].tolist() == below(machine, poses, some, level)


def test_a_mode_that_comes_down_between_the_nodes_is_counted(tmp_path: Path, pool: ThreadPoolExecutor) -> None:
    """The plunger is nearly loose within a hundredth of a degree, where no node is."""
    machine = nasty(tmp_path, (12.0, 13.0, 14.0, 15.0, 18.0, 22.5), 4e4)
    poses = poses_of(machine, {"phi": np.pi / 2.0 + np.linspace(-0.9, 0.5, 421)})
    level = (2.0 * np.pi * 25.0) ** 2
    found = made(machine, poses, level, pool)
    assert len(found.box.solved) < 40
    most = found.at_most(poses)(0, poses.size)
    exact = np.array(below(machine, poses, np.arange(poses.size), level))
    assert exact.max() > np.median(exact)
    assert (most >= exact).all()
    assert np.mean(most == exact) > 0.7


def test_pivots_of_one_sign_are_eliminated(
    head: prs.Machine, pool: ThreadPoolExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With and without elimination the counts are the same; it takes nearly all rows."""
    poses = poses_of(head, {"nutation": np.linspace(0.0, 0.5, 20), "precession": np.linspace(0.0, 1.0, 30)})
    few = made(head, poses, LEVEL, pool)
    monkeypatch.setattr(pivots, "_CHANGES", 0.0)
    every = made(head, poses, LEVEL, pool)
    assert every.size == 159
    assert few.size < 10
    some, all_of_them = (each.at_most(poses)(0, poses.size) for each in (few, every))
    np.testing.assert_array_equal(some, all_of_them)


def test_a_travelling_part_whose_own_mode_crosses_the_level_is_no_obstacle(
    tmp_path: Path, pool: ThreadPoolExecutor
) -> None:
    machine = gantry(tmp_path, travel=TRAVEL)
    column = next(part for part in machine.parts.values() if not isinstance(part, prs.SuperElement))
    own = [column.at(float(at)).frequencies(3)[0] for at in (column.stations[0], column.stations[-1])]
    poses = poses_of(machine, {"x": np.linspace(0.3, 0.45, 500)})
    level = (np.pi * sum(own)) ** 2
    found = made(machine, poses, level, pool)
    some = np.arange(0, 500, 50)
    most, exact = found.at_most(poses)(0, 500)[some], np.array(below(machine, poses, some, level))
    assert (most >= exact).all()
    assert np.mean(most == exact) > 0.7
