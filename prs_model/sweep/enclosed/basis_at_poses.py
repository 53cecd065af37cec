"""Making a basis that serves at all poses of a sweep: shapes at some of them, until its bounds are small at others."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...linear_algebra import slowest_rate
from ..exact import Solved, Solver
from ..not_smooth import NotSmoothError
from ..poses import Poses
from ..request import Request
from ..rounding import rounding
from . import kernels_ritz as plain
from .ritz import RitzBasis, leading_shapes
from .ritz_at_poses import RitzAtPoses

_FIRST, _FURTHER, _ROUNDS = 96, 64, 4  # poses whose shapes a basis is made of
_HELD_OUT = 192  # poses at which its bounds are looked at
_SIZES = (18, 21, 24, 27, 30, 33, 36, 39, 42, 46, 50, 55, 60, 66, 72, 80, 90)  # shapes of a basis
_SHARE = 0.98  # of the poses held out, at which bounds have to be small
_SHIFT = 0.1  # below zero, of the largest lowest eigenvalue
_ABOVE = 1.3  # times the highest eigenvalue asked for: the level below which eigenvalues are counted
_SINGULAR = 1e-11  # of the largest eigenvalue of S
_FOLLOWED = 4  # modes above those asked for, and more until one is above the level: all below it lend their shapes


def ritz_at_poses(
    request: Request, solver: Solver, poses: Poses, pool: ThreadPoolExecutor, kernels: Any = plain
) -> tuple[RitzAtPoses, str]:
    """The smallest basis whose bounds are within the tolerance at nearly all poses that were tried, and in
    words how it was found. The numbers of poses are drawn with a fixed seed.

    Poses whose bounds are too large lend their shapes to the next attempt. Raises NotSmoothError where that leads
    nowhere or none of the poses is within reach, PrsError for a singular system.
    """
    if request.quantities != ("frequency",):
        raise NotSmoothError("shapes in one basis for all poses give frequencies only")
    rng = np.random.default_rng(4)
    first = _reachable(solver, poses, np.append(_extremes(poses), _drawn(poses, _FIRST, rng)))
    _check_rigid_joints(solver, first[:1])
    solver, snapshots = _first_snapshots(request, solver, first, pool)
    for _ in range(_ROUNDS):
        held_out = _reachable(solver, poses, _drawn(poses, _HELD_OUT, rng))
        for size in _SIZES:
            found = _basis(request, solver, snapshots, size)
            worst = _worst_bounds(found, solver, held_out, request, kernels)
            if np.mean(worst <= request.tolerance) >= _SHARE:
                return found, _in_words(found.basis, snapshots, worst)
            if found.basis.size < size:
                break
        snapshots += _solved(solver, held_out[np.argsort(worst)[-_FURTHER:]], pool)
    raise NotSmoothError(f"{found.basis.size} shapes are not enough for all poses")


def _check_rigid_joints(solver: Solver, pose: FloatArray) -> None:
    """Raises NotSmoothError where S is singular below all eigenvalues, at one pose (1, d)."""
    S, _ = solver.dual(solver.machine.kinematics.solve_batch(pose)).at(-1.0)
    scale = 1.0 / np.sqrt(np.diagonal(S[0]).clip(np.finfo(float).tiny))
    if np.linalg.eigvalsh(S[0] * np.outer(scale, scale))[0] < _SINGULAR:
        raise NotSmoothError("rigid joints hold a motion twice, or what moves has no mass")


def _first_snapshots(
    request: Request, solver: Solver, poses: FloatArray, pool: ThreadPoolExecutor
) -> tuple[Solver, list[Solved]]:
    """With all modes below the level; and the solver for as many."""
    solver = replace(solver, count=request.n_modes + _FOLLOWED)
    while True:
        snapshots = _solved(solver, poses, pool)
        values = _eigenvalues(snapshots)
        if values.shape[1] < request.n_modes:
            raise NotSmoothError(f"only {values.shape[1]} modes")
        if values.shape[1] < solver.count or values[:, -1].min() > _level(request, values):
            return solver, snapshots
        solver = replace(solver, count=2 * solver.count)


def _level(request: Request, values: FloatArray) -> float:
    return _ABOVE * float(values[:, request.n_modes - 1].max())


def _eigenvalues(snapshots: list[Solved]) -> FloatArray:
    fewest = min(each.modes.eigenvalues.shape[1] for each in snapshots)
    return np.concatenate([each.modes.eigenvalues[:, :fewest] for each in snapshots])


def _basis(request: Request, solver: Solver, snapshots: list[Solved], size: int) -> RitzAtPoses:
    """From the modes below the level."""
    values = _eigenvalues(snapshots)
    level = _level(request, values)
    shapes = np.concatenate([each.modes.shapes[:, :, : values.shape[1]] for each in snapshots])
    columns = shapes.swapaxes(1, 2)[values < level].T
    shift = min(solver.shift, -_SHIFT * float(values[:, 0].max()))
    basis = RitzBasis(leading_shapes(snapshots[0].systems.mass[0], columns, size), shift, level)
    return RitzAtPoses(basis, max(_rounding(each, request.n_modes) for each in snapshots))


def _rounding(solved: Solved, count: int) -> float:
    """Of a frequency, at most."""
    systems, modes = solved.systems, solved.modes
    mass, stiffness = (np.diagonal(each, axis1=1, axis2=2) for each in (systems.mass, systems.stiffness))
    rate = np.array([slowest_rate(mass, stiffness) for mass, stiffness, _ in systems.pencils])
    return float(np.nanmax(rounding(modes.eigenvalues, modes.shapes, mass, stiffness, rate)[:, :count], initial=0.0))


def _worst_bounds(found: RitzAtPoses, solver: Solver, poses: FloatArray, request: Request, kernels: Any) -> FloatArray:
    """Of each pose (m,), infinite where modes may be missing."""
    configurations = solver.machine.kinematics.solve_batch(poses)
    _, bounds, complete = found.at(solver.machine, configurations, request.n_modes, kernels)
    return np.where(complete, bounds.max(axis=1), np.inf)


def _solved(solver: Solver, poses: FloatArray, pool: ThreadPoolExecutor) -> list[Solved]:
    return list(solver.each(poses, _kept, pool))


def _kept(solved: Solved) -> Solved:
    return solved


def _reachable(solver: Solver, poses: Poses, numbers: IntArray) -> FloatArray:
    """Those of the poses (m, d) with these numbers that are within reach."""
    chosen = poses.at(np.unique(numbers))
    chosen = chosen[solver.machine.kinematics.solve_batch(chosen).reachable]
    if not len(chosen):
        raise NotSmoothError("none of the poses that were tried is within reach")
    return chosen


def _drawn(poses: Poses, count: int, rng: np.random.Generator) -> IntArray:
    return np.asarray(rng.choice(poses.size, min(count, poses.size), replace=False))


def _extremes(poses: Poses) -> IntArray:
    """The numbers of the corners of a grid; of a list, those of the least and largest value of each coordinate."""
    if poses.points is not None:
        return np.append(poses.points.argmin(axis=0), poses.points.argmax(axis=0))
    corners = np.array(list(product(*[sorted({0, length - 1}) for length in poses.shape])), dtype=np.int64)
    return np.asarray(np.ravel_multi_index(tuple(corners.T), poses.shape))


def _in_words(basis: RitzBasis, snapshots: list[Solved], worst: FloatArray) -> str:
    poses, level = sum(len(each.modes.eigenvalues) for each in snapshots), np.sqrt(basis.level) / (2.0 * np.pi)
    sure = worst[np.isfinite(worst)]
    return (
        f"{basis.size} shapes from {poses} poses, counted below {level:.1f} Hz at every pose; "
        f"largest bound at {len(sure)} others {sure.max():.1e}"
    )
