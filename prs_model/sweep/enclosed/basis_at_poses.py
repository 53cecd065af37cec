"""Making a basis that serves at all poses of a sweep: shapes at some of them, until its bounds are small at others."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...linear_algebra import slowest_rate
from ...synthesis.redundancy import without_redundant
from ..exact import Solved, Solver, eigenvalues_of
from ..not_smooth import NotSmoothError
from ..poses import Poses
from ..request import Request
from ..rounding import is_rigid, rounding
from . import kernels_ritz as plain
from .dual_packed import packed
from .dual_rounding import dual_rounding
from .ritz_at_poses import RitzAtPoses

_FIRST, _FURTHER, _ROUNDS = 96, 64, 4  # poses whose shapes a basis is made of
_HELD_OUT = 192  # poses at which its bounds are looked at
_BESIDE_DENSE = 24  # of these, at which its frequencies are held against those of the dense solver
_NEGLIGIBLE = 1e-3  # of the tolerance
_SIZES = (18, 21, 24, 27, 30, 33, 36, 39, 42, 46, 50, 55, 60, 66, 72, 80, 90, 100, 112, 126)  # shapes of a basis
_SHARE = 0.98  # of the poses held out, at which bounds have to be small
_SHIFT = 0.1  # below zero, of the highest eigenvalue asked for
_ABOVE = 1.3  # times the highest eigenvalue asked for: the level below which eigenvalues are counted
_FOLLOWED = 4  # modes above those asked for, and more until one is above the level: all below it lend their shapes


def ritz_at_poses(
    request: Request, solver: Solver, poses: Poses, pool: ThreadPoolExecutor, kernels: Any = plain
) -> tuple[RitzAtPoses, str]:
    """The smallest basis whose bounds are within the tolerance at nearly all poses that were tried, and in
    words how it was found. The numbers of poses are drawn with a fixed seed.

    Poses whose bounds are too large lend their shapes to the next attempt. Raises NotSmoothError where that leads
    nowhere, bounds do not hold beside the dense solver or none of the poses is within reach, PrsError for a singular
    system.
    """
    if request.quantities != ("frequency",):
        raise NotSmoothError("shapes in one basis for all poses give frequencies only")
    try:
        return _found(request, solver, poses, pool, kernels)
    except np.linalg.LinAlgError as error:
        raise NotSmoothError(f"the dual form is singular ({error})") from error


def _found(
    request: Request, solver: Solver, poses: Poses, pool: ThreadPoolExecutor, kernels: Any
) -> tuple[RitzAtPoses, str]:
    rng = np.random.default_rng(4)
    first = _reachable(solver, poses, np.append(_extremes(poses), _drawn(poses, _FIRST, rng)))
    solver, snapshots = _first_snapshots(request, solver, first, pool)
    _check_held(request, snapshots)
    for _ in range(_ROUNDS):
        most = _basis(request, solver, snapshots)
        _check_rounding(request, most, snapshots)
        _check_regular(most, solver, first, kernels)
        held_out = _reachable(solver, poses, _drawn(poses, _HELD_OUT, rng))
        found, worst = _smallest(most, solver, held_out, request, kernels)
        if _serves(worst, request):
            _check_beside_dense(found, solver, held_out, request, kernels)
            return found, _in_words(found, snapshots, worst)
        snapshots += _solved(solver, held_out[np.argsort(worst)[-_FURTHER:]], pool)
    raise NotSmoothError(f"{most.size} shapes are not enough for all poses")


def _first_snapshots(
    request: Request, solver: Solver, poses: FloatArray, pool: ThreadPoolExecutor
) -> tuple[Solver, list[Solved]]:
    """With all modes below the level; and the solver for as many."""
    solver = replace(solver, count=request.n_modes + _FOLLOWED)
    while True:
        snapshots = _solved(solver, poses, pool)
        values = eigenvalues_of(snapshots)
        if values.shape[1] < request.n_modes:
            raise NotSmoothError(f"only {values.shape[1]} modes")
        if values.shape[1] < solver.count or values[:, -1].min() > _level(request, values):
            return solver, snapshots
        solver = replace(solver, count=2 * solver.count)


def _level(request: Request, values: FloatArray) -> float:
    return _ABOVE * float(values[:, request.n_modes - 1].max())


def _rates(solved: Solved) -> FloatArray:
    return np.array([slowest_rate(mass, stiffness) for mass, stiffness, _ in solved.systems.pencils])


def _check_held(request: Request, snapshots: list[Solved]) -> None:
    """Raises NotSmoothError where modes strain nothing, at more poses than may be left to the dense solver."""
    rigid = [is_rigid(each.modes.eigenvalues[:, : request.n_modes], _rates(each)).any(axis=1) for each in snapshots]
    if np.mean(np.concatenate(rigid)) > 1.0 - _SHARE:
        raise NotSmoothError("modes that strain nothing have no relative error")


def _check_rounding(request: Request, found: RitzAtPoses, snapshots: list[Solved]) -> None:
    """Raises NotSmoothError where rounding alone is too much, as it is for frequencies far below others."""
    if found.rounding.max() > request.tolerance:
        low, high = np.sqrt(np.abs(eigenvalues_of(snapshots)[0, [0, request.n_modes - 1]])) / (2.0 * np.pi)
        off = f"rounding of {found.rounding.max():.1e} in one basis for all poses"
        raise NotSmoothError(f"{off}, with frequencies from {low:.3g} to {high:.3g} Hz")


def _check_regular(found: RitzAtPoses, solver: Solver, poses: FloatArray, kernels: Any) -> None:
    """Raises NotSmoothError where S is singular below all eigenvalues, at some of the poses."""
    dual = without_redundant(solver.dual(solver.machine.kinematics.solve_batch(poses[:_BESIDE_DENSE])))
    _, sure = kernels.below(packed(dual, found.shapes[:, :0], found.shift, found.shift))
    if not sure.any():
        raise NotSmoothError("the dual form is singular: rigid joints hold a motion twice, though not at all poses")


def _basis(request: Request, solver: Solver, snapshots: list[Solved]) -> RitzAtPoses:
    """The largest, from the modes below the level; the first of its shapes are a smaller one."""
    values = eigenvalues_of(snapshots)
    level = _level(request, values)
    shapes = np.concatenate([each.modes.shapes[:, :, : values.shape[1]] for each in snapshots])
    columns = shapes.swapaxes(1, 2)[values < level].T
    shift = min(solver.shift, -_SHIFT * float(values[:, request.n_modes - 1].max()))
    return RitzAtPoses(
        leading_shapes(snapshots[0].systems.mass[0], columns, _SIZES[-1]),
        shift,
        level,
        max(float(_rates(each).max()) for each in snapshots),
        np.max([_rounding(each, solver, request.n_modes, shift) for each in snapshots], axis=0),
    )


def leading_shapes(mass: FloatArray, shapes: FloatArray, most: int) -> FloatArray:
    """The combinations (n, r) of shapes (n, k), orthonormal in M (n, n), that hold most of them, in that order."""
    inertias, turn = np.linalg.eigh(mass)
    some = inertias > 1e-14 * inertias[-1]
    scaled = np.sqrt(inertias[some])[:, None] * (turn[:, some].T @ shapes)
    values, vectors = np.linalg.eigh(scaled @ scaled.T)
    order = slice(None, -most - 1, -1)
    kept = values[order] > 1e-12 * values[-1]
    return np.asarray(shapes @ (scaled.T @ (vectors[:, order][:, kept] / values[order][kept])))


def _rounding(solved: Solved, solver: Solver, count: int, shift: float) -> FloatArray:
    """Of the frequencies asked for (p,), where it is largest."""
    dual, modes = without_redundant(solver.dual(solved.configurations)), solved.modes
    return np.asarray(dual_rounding(dual, modes.eigenvalues[:, :count], modes.shapes[:, :, :count], shift).max(axis=0))


def _smallest(
    most: RitzAtPoses, solver: Solver, poses: FloatArray, request: Request, kernels: Any
) -> tuple[RitzAtPoses, FloatArray]:
    """The smallest basis that serves, found by bisection, or else all of it; and its worst bounds (m,)."""
    found, worst = most, _worst_bounds(most, solver, poses, request, kernels)
    sizes = [size for size in _SIZES if request.n_modes <= size < most.size]
    low, high = 0, len(sizes) if _serves(worst, request) else 0
    while low < high:
        middle = (low + high) // 2
        basis = replace(most, shapes=most.shapes[:, : sizes[middle]])
        bounds = _worst_bounds(basis, solver, poses, request, kernels)
        if _serves(bounds, request):
            found, worst, high = basis, bounds, middle
        else:
            low = middle + 1
    return found, worst


def _serves(worst: FloatArray, request: Request) -> bool:
    return bool(np.mean(worst <= request.tolerance) >= _SHARE)


def _worst_bounds(found: RitzAtPoses, solver: Solver, poses: FloatArray, request: Request, kernels: Any) -> FloatArray:
    """Of each pose (m,), infinite where modes may be missing."""
    configurations = solver.machine.kinematics.solve_batch(poses)
    _, bounds, _ = found.at(solver.machine, configurations, request.n_modes, kernels)
    return np.asarray(bounds.max(axis=1))


def _check_beside_dense(found: RitzAtPoses, solver: Solver, poses: FloatArray, request: Request, kernels: Any) -> None:
    """Raises NotSmoothError where a frequency is further from that of the dense solver than both are sure of, by more
    than is negligible."""
    some = poses[:: -(-len(poses) // _BESIDE_DENSE)]
    solved = replace(solver, count=request.n_modes).solve(solver.machine.kinematics.solve_batch(some))
    values = solved.modes.eigenvalues
    mass, stiffness = (np.diagonal(each, axis1=1, axis2=2) for each in (solved.systems.mass, solved.systems.stiffness))
    theirs = rounding(values, solved.modes.shapes, mass, stiffness, _rates(solved))
    frequencies, bounds, complete = found.at(solver.machine, solved.configurations, request.n_modes, kernels)
    off = np.abs(2.0 * np.pi * frequencies[complete] / np.sqrt(values[complete]) - 1.0)
    if not np.all(off <= bounds[complete] + theirs[complete] + _NEGLIGIBLE * request.tolerance):
        raise NotSmoothError(
            f"frequencies in one basis for all poses are off by {off.max():.1e}, more than their bounds"
        )


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


def _in_words(found: RitzAtPoses, snapshots: list[Solved], worst: FloatArray) -> str:
    poses, level = sum(len(each.modes.eigenvalues) for each in snapshots), np.sqrt(found.level) / (2.0 * np.pi)
    sure = worst[np.isfinite(worst)]
    return (
        f"{found.size} shapes from {poses} poses, counted below {level:.1f} Hz at every pose; "
        f"largest bound at {len(sure)} others {sure.max():.1e}"
    )
