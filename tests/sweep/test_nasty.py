"""Maps on which a method without checks is wrong; Machine.sweep stays within its bounds, or solves every pose."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.exact import CHUNK, Solver, part
from prs_model.sweep.interpolated.spectral import Axis, Box, on_grid
from prs_model.sweep.poses import Poses, poses_of
from tests.sweep.nasty import nasty, polar

COUNT, NODES = 6, 7


@dataclass(frozen=True)
class Case:
    """Frequencies of the row of masses and of the plunger [Hz], and a grid that meets the difficulty."""

    row: tuple[float, ...]
    plunger: float
    grid: dict[str, np.ndarray]
    interpolated: bool | None = None


SQUARE = {"x": np.linspace(0.3, 1.0, 22), "y": np.linspace(0.3, 1.0, 22)}
LINE = {"x": np.linspace(0.3, 1.0, 420)}
ASIDE = {"x": np.linspace(-1.0, 0.0, 21), "y": np.linspace(-1.0, 0.0, 21)}
TURNED = {"phi": np.linspace(0.2, 1.6, 24), "x": np.linspace(0.3, 0.6, 20)}
ACROSS = {"phi": np.pi / 2.0 + np.linspace(-0.9, 0.5, 421)}
NO_GAP = tuple(40.0 * 1.01**k for k in range(24))
ROW = (12.0, 13.0, 14.0, 15.0, 18.0, 22.5)
CASES = {
    "crossings": Case((30.0, 40.0, 41.0, 55.0, 70.0, 300.0), 4000.0, SQUARE, True),
    "a repeated pair": Case((35.0, 35.0, 50.0, 50.0, 50.0, 300.0), 4000.0, SQUARE, True),
    "no gap": Case(NO_GAP[:16], 4000.0, LINE),
    "a mode that comes down in a corner": Case(ROW, 4000.0, ASIDE),
    "a pose where it is nearly loose": Case((20.0, 25.0, 33.0, 47.0, 60.0, 75.0), 200.0, TURNED),
    "such a pose beside which nothing shows": Case(ROW, 4e4, ACROSS),
    "all at once": Case((*NO_GAP[:16], 35.0, 35.0), 200.0, TURNED),
}


@pytest.fixture(params=CASES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def unguarded(machine: prs.Machine, grid: dict[str, np.ndarray]) -> np.ndarray:
    """Sorted frequencies (N, COUNT) [Hz] interpolated from Chebyshev nodes, which is exact for smooth ones."""
    names = [name for name in machine.pose_names if name in grid]
    axes = tuple(Axis("chebyshev", grid[name][0], grid[name][-1], NODES) for name in names)
    columns = tuple(machine.pose_names.index(name) for name in names)
    box = Box(axes, columns, np.array(list(machine.reference_pose.values())))
    at_nodes = np.array([modes_at(machine, pose) for pose in box.poses()])
    weights = [axis.weights(grid[name]) for axis, name in zip(axes, names, strict=True)]
    return on_grid(np.moveaxis(box.unfold(at_nodes), -1, 0), weights).reshape(COUNT, -1).T


def modes_at(machine: prs.Machine, pose: np.ndarray) -> np.ndarray:
    return machine.modes(COUNT, **dict(zip(machine.pose_names, pose.tolist(), strict=True))).frequencies


def exact(machine: prs.Machine, poses: Poses) -> np.ndarray:
    """(N, COUNT) at every pose [Hz], solved one by one."""
    systems = machine.kinematics.solve_batch(poses.block(0, poses.size))
    solver = Solver(machine, COUNT, 0.0)
    chunks = [solver.solve(part(systems, slice(k, k + CHUNK))).modes.eigenvalues for k in range(0, poses.size, CHUNK)]
    return np.sqrt(np.concatenate(chunks)) / (2.0 * np.pi)


def test_the_map_is_within_its_bounds_where_an_unguarded_method_is_not(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    machine = nasty(tmp_path, case.row, case.plunger)
    poses = poses_of(machine, case.grid)
    truth = exact(machine, poses)
    for i in np.random.default_rng(14).choice(poses.size, 5, replace=False):
        np.testing.assert_allclose(modes_at(machine, poses.block(i, i + 1)[0]), truth[i], rtol=1e-9)
    assert np.abs(unguarded(machine, case.grid) / truth - 1.0).max() > 1e-3
    data = machine.sweep(**case.grid, n_modes=COUNT)
    frequency, bound = (data[name].values.reshape(-1, COUNT) for name in ("frequency", "bound"))
    assert (np.abs(frequency / truth - 1.0) <= bound + 1e-9).all()
    assert bound.max() <= 1e-6
    if case.interpolated is not None:
        assert (data["proof"].values == (1 if case.interpolated else 2)).all()


@pytest.mark.parametrize("distance", [1e-2, 5e-2])
def test_what_happens_within_millimetres_between_nodes_is_noticed(distance: float, tmp_path: Path) -> None:
    """A polar arm passes the axis: its table turns by half a turn there, and the plunger is nearly loose on the way.

    At the nodes nothing moves but the turn itself, and frequencies are those of the row of masses.
    """
    machine = polar(tmp_path, ROW, 400.0)
    grid = {"x": np.linspace(-1.0, 0.73, 4001), "y": [distance]}
    data = machine.sweep(**grid, n_modes=COUNT)
    poses = poses_of(machine, grid)
    near = np.flatnonzero(np.abs(grid["x"]) < 0.2 * distance)[::2]
    for i in (*near.tolist(), 0, 1500, 3000, 4000):
        truth = modes_at(machine, poses.block(i, i + 1)[0])
        found = data["frequency"].values.reshape(-1, COUNT)[i]
        assert (np.abs(found / truth - 1.0) <= data["bound"].values.reshape(-1, COUNT)[i] + 1e-9).all()
    lowest = data["frequency"].values.reshape(-1, COUNT)[:, 0]
    assert lowest.min() < 0.9 * np.median(lowest)
