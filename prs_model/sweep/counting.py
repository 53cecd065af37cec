"""How many eigenvalues lie below a level at every pose, so that no mode is missed.

S of the dual assembly (see `synthesis.dual`) tells it. Its entries hold what every part and joint does, and are as
smooth in the pose as the joints' values are: a mode cannot hide between the nodes of its interpolant, as it might
between those of the modes themselves. At each pose the eigenvalues are counted by LDL^T of S + d, where d is more than
the interpolant may be off, so that the count is never too small.

Joint after joint, the block of S that belongs to it is eliminated at the nodes, if it is nowhere singular: with
coefficients c_k of terms t_k, none of which exceeds one,

    S_jj(x) = c_0 + sum c_k t_k(x),   sum || |c_0|^-1/2 c_k |c_0|^-1/2 || < 1,

it has as many negative eigenvalues everywhere as c_0. What remains of S is interpolated and counted at every pose.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..reduction import Elements
from ..synthesis import DualSystems
from . import kernels as plain
from .approaches import NotSmoothError
from .box_of import Shape
from .exact import Solver
from .kernels import as_frobenius
from .poses import Poses
from .spectral import Box
from .tensor import Tensor

_FEWEST = 7  # nodes along an axis, to begin with
_ENLARGED = 1.4
_MOST = 2500  # nodes
_SLACK = 0.02  # allowed, of what remains of S, whose eigenvalues are about 1 and -1
_SHARPEST = 1e-6  # of the same, below which it is not made smaller
_ROUNDING = 1e-7
_FLOOR = 1e-9  # of the largest eigenvalue of S: those of redundant rigid joints are smaller
_CHANGES = 0.9  # of a block that is eliminated, at most
_AWAY = 1.2  # factor by which eigenvalues of a part that changes keep away from the level
_HELD_OUT = 8
_SURE = 0.7  # share of the poses held out


@dataclass(frozen=True, eq=False)
class Counting(Tensor):
    """A tensor of what remains of S, packed, in axes in which it is about 1 and -1; `size` is the number of rows.

    level: below which eigenvalues are counted [rad^2/s^2]. constant: those of the bodies alone less the negative ones
    that were eliminated. slack: more than S is off, anywhere.
    """

    level: float
    constant: int
    size: int
    slack: float

    def at_most(self, values: FloatArray, kernels: Any = plain) -> IntArray:
        """How many eigenvalues lie below the level at most (m,), by interpolated values (e, m); -1 where in doubt."""
        negative = kernels.negatives(values, self.size, self.slack)
        return np.where(negative < 0, -1, self.constant - negative)


@dataclass(frozen=True, eq=False)
class _Rest:
    """What remains of S: of rows `kept`, after those of each joint in `eliminated` in turn; `turned` to its axes."""

    eliminated: tuple[IntArray, ...]
    kept: IntArray
    turned: FloatArray

    def packed(self, S: FloatArray) -> FloatArray:
        """(N, r (r + 1) / 2), of S (N, c, c)."""
        for rows in self.eliminated:
            S = _without(S, rows)
        rows, columns = np.tril_indices(len(self.kept))
        return np.asarray((self.turned.T @ S[:, self.kept[:, None], self.kept] @ self.turned)[:, rows, columns])


def counting(solver: Solver, shape: Shape, poses: Poses, level: float, pool: ThreadPoolExecutor) -> Counting:
    """Made on a box of its own, with more nodes until some of `poses` are counted without doubt.

    Raises NotSmoothError where a part alone has an eigenvalue at the level, or too many nodes would be needed.
    """
    counts: tuple[int, ...] = (_FEWEST,) * len(shape.columns)
    wanted, best = _SLACK, None
    while len((box := shape.box(counts)).solved) <= min(_MOST, poses.size / 2):
        found, rest, tails = _on(box, solver, level, pool)
        if found.slack <= wanted:
            holds, sharp = _held_out(found, rest, solver, poses, pool)
            if holds and (sharp or found.slack <= _SHARPEST):
                return found
            if holds:
                wanted, best = 0.1 * found.slack, found
        counts = tuple(
            int(np.ceil(count * _ENLARGED)) if tail > 0.2 * max(tails) else count
            for count, tail in zip(box.shape, tails, strict=True)
        )
    if best is None:
        raise NotSmoothError(f"{len(box.solved)} nodes would be needed to count modes")
    return best


def _on(box: Box, solver: Solver, level: float, pool: ThreadPoolExecutor) -> tuple[Counting, _Rest, tuple[float, ...]]:
    """With the nodes of a box; what remains of S; and its error that is due to each axis."""
    S, below, owners = _dual(solver, box.poses(), level, pool)
    rest, negative = _eliminated(box, S, owners)
    nodes = box.unfold(rest.packed(S))
    tails = box.tail(as_frobenius(nodes))
    slack = 2.0 * sum(tails) + _ROUNDING
    return Counting(box, nodes, 0.1 * slack, level, below - negative, len(rest.kept), slack), rest, tails


def _dual(
    solver: Solver, poses: FloatArray, level: float, pool: ThreadPoolExecutor
) -> tuple[FloatArray, int, tuple[str, ...]]:
    """S (N, c, c) at poses (N, d), how many eigenvalues the bodies alone have below the level, and whose the rows are.

    Raises NotSmoothError where that number changes, or might change in between.
    """

    def at_level(dual: DualSystems) -> tuple[FloatArray, IntArray, tuple[str, ...]]:
        if not _keep_away(dual.elements.values(), level):
            raise NotSmoothError("a part alone has a mode near the level")
        return *dual.at(level), dual.rows

    chunks = list(solver.each_dual(poses, at_level, pool))
    below = np.concatenate([chunk[1] for chunk in chunks])
    if np.ptp(below):
        raise NotSmoothError("a part alone has a mode that crosses the level")
    return np.concatenate([chunk[0] for chunk in chunks]), int(below[0]), chunks[0][2]


def _keep_away(elements: Iterable[Elements], level: float) -> bool:
    """Whether no eigenvalue of a part that follows a travelling contact is near the level in any configuration."""
    changing = [each for each in elements if len(each.mass) > 1]
    near = (level / _AWAY, level * _AWAY)
    counts = [[np.linalg.eigvalsh(each.stiffness - at * each.mass) < 0.0 for at in near] for each in changing]
    return all(np.array_equal(below.sum(axis=1), above.sum(axis=1)) for below, above in counts)


def _eliminated(box: Box, S: FloatArray, owners: Sequence[str]) -> tuple[_Rest, int]:
    """What remains of S (N, c, c), and how many negative eigenvalues were eliminated. owners: of the rows."""
    names, negative = np.array(owners), 0
    left = sorted(dict.fromkeys(owners), key=lambda name: -int(np.sum(names == name)))
    eliminated: list[IntArray] = []

    def hardly_changes(name: str) -> bool:
        own = np.flatnonzero(names == name)
        return _changes(box, S[:, own[:, None], own]) < _CHANGES

    while name := next(filter(hardly_changes, left), None):
        rows = np.flatnonzero(names == name)
        negative += int((np.linalg.eigvalsh(S[0][np.ix_(rows, rows)]) < 0.0).sum())
        S = _without(S, rows)
        eliminated.append(rows)
        left.remove(name)
    kept = np.flatnonzero(np.isin(names, left))
    mean = _coefficients(box, S[:, kept[:, None], kept])[(0,) * len(box.axes)]
    return _Rest(tuple(eliminated), kept, _to_ones(mean)[0]), negative


def _without(S: FloatArray, rows: IntArray) -> FloatArray:
    """S (N, c, c) after some rows are eliminated: the Schur complement in those coupled to them; theirs are zero."""
    S = S.copy()
    coupled = np.setdiff1d(np.flatnonzero(np.any(S[:, rows], axis=(0, 1))), rows)
    beside = S[:, rows[:, None], coupled]
    S[:, coupled[:, None], coupled] -= beside.swapaxes(1, 2) @ np.linalg.solve(S[:, rows[:, None], rows], beside)
    S[:, rows] = 0.0
    S[:, :, rows] = 0.0
    return S


def _changes(box: Box, blocks: FloatArray) -> float:
    """By how much blocks (N, b, b) at the nodes, seen as 1 and -1, change over the box; infinite for singular ones."""
    coefficients = _coefficients(box, blocks)
    turned, singular = _to_ones(coefficients[(0,) * len(box.axes)])
    if singular:
        return float("inf")
    sizes = np.abs(np.linalg.eigvalsh(turned.T @ coefficients @ turned)).max(axis=-1)
    sizes[(0,) * len(box.axes)] = 0.0
    smooth = tuple(k for k, axis in enumerate(box.axes) if axis.given is None)
    return float(sizes.sum(axis=smooth).max())


def _coefficients(box: Box, blocks: FloatArray) -> FloatArray:
    """(.., b, b) of the terms along the axes, of blocks (N, b, b); the first is what does not change.

    Of an axis of given nodes they are differences from the first node.
    """
    found = box.coefficients(box.unfold(blocks.reshape(len(blocks), -1)))
    for k, axis in enumerate(box.axes):
        if axis.given is not None:
            found = np.concatenate([np.take(found, [0], k), np.diff(found, axis=k).cumsum(axis=k)], axis=k)
    return found.reshape(*found.shape[:-1], *blocks.shape[1:])


def _to_ones(matrix: FloatArray) -> tuple[FloatArray, bool]:
    """T (b, b) with eigenvalues 1 and -1 of T^T A T, near zero for a singular A; and whether it is singular."""
    scale = 1.0 / np.sqrt(np.maximum(np.linalg.norm(matrix, axis=1), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(matrix * np.outer(scale, scale))
    least = _FLOOR * np.abs(values).max(initial=0.0)
    sizes = np.maximum(np.abs(values), least)
    return scale[:, None] * vectors / np.sqrt(sizes), bool(np.any(np.abs(values) <= least))


def _held_out(
    found: Counting, rest: _Rest, solver: Solver, poses: Poses, pool: ThreadPoolExecutor
) -> tuple[bool, bool]:
    """Of some of the poses: whether the interpolant is within its slack, and whether this is small enough for the
    count to be that without it at most of them."""
    numbers = np.random.default_rng(5).choice(poses.size, min(_HELD_OUT, poses.size), replace=False)
    some = poses.at(np.sort(numbers))
    some = some[solver.machine.kinematics.solve_batch(some).reachable]
    if not len(some):
        return True, True
    exact = rest.packed(_dual(solver, some, found.level, pool)[0]).T
    errors = as_frobenius((exact - found.reader(Poses(poses.names, (), some))(0, len(some))).T)
    counts = (plain.negatives(exact, found.size, slack) for slack in (found.slack, _ROUNDING))
    return bool(np.linalg.norm(errors, axis=1).max() <= found.slack), bool(np.mean(np.equal(*counts)) > _SURE)
