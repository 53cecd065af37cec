"""How many eigenvalues lie below a level at every pose, so that no mode is missed.

S of the dual assembly (see `synthesis.dual`) tells it. Its entries hold what every part and joint does, and are as
smooth in the pose as the joints' values are: a mode cannot hide between the nodes of its interpolant, as it might
between those of the modes themselves. At each pose the eigenvalues are counted by LDL^T of S + d, where d is more than
the interpolant may be off, so that the count is never too small.

Row after row, S is eliminated at the nodes as long as the pivot is nowhere zero: with coefficients c_k of terms t_k,
none of which exceeds one,

    pivot(x) = c_0 + sum c_k t_k(x),   sum |c_k| < |c_0|,

the pivot has the sign of c_0 at every pose. Often no row is left, and the number is the same all over the box. What
is left otherwise is interpolated and counted at every pose.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...reduction import Elements
from ...synthesis import DualSystems
from .. import kernels as plain
from ..exact import Solver
from ..kernels import as_frobenius
from ..not_smooth import NotSmoothError
from ..poses import Poses
from .box_of import Shape
from .spectral import Box
from .tensor import Tensor

Counter = Callable[[int, int], IntArray]

_FEWEST, _ROUND, _ACROSS = 6, 17, 10  # nodes to begin with: along an axis, a periodic one, one that is mirrored
_ENLARGED = 1.4
_MOST = 2500  # nodes
_SLACK = 0.2  # allowed, of what remains of S, whose eigenvalues are about 1 and -1
_SHARPEST = 1e-6  # of the same, below which it is not made smaller
_ROUNDING = 2e-7
_ZERO = 1e-10  # of eigenvalues of S with rows of unit size
_FLOOR = 1e-9  # of the largest eigenvalue of S: those of redundant rigid joints are smaller
_CHANGES = 0.7  # of a pivot that is eliminated, at most: well away from zero, it leaves smooth what remains
_LAST, _LEFT_OUT = 2, 3.0  # terms along an axis that count so many times, for those left out
_AWAY = 1.2  # factor by which eigenvalues of a part that changes keep away from the level
_HELD_OUT = 8
_SURE = 0.7  # share of the poses held out


@dataclass(frozen=True, eq=False)
class Counting(Tensor):
    """A tensor of what remains of S, packed, in axes in which it is about 1 and -1; `size` is the number of rows.

    level: below which eigenvalues are counted [rad^2/s^2]. constant: those of the bodies alone, less the negative
    pivots. slack: more than what remains is off, anywhere.
    """

    level: float
    constant: int
    size: int
    slack: float

    def at_most(self, poses: Poses, kernels: Any = plain) -> Counter:
        """How many eigenvalues lie below the level, at most, at the poses start .. stop - 1; -1 where in doubt."""
        if not self.size:
            return lambda start, stop: np.full(stop - start, self.constant)
        values = self.reader(poses)

        def counts(start: int, stop: int) -> IntArray:
            negative = kernels.negatives(values(start, stop), self.size, self.slack)
            return np.where(negative < 0, -1, self.constant - negative)

        return counts


@dataclass(frozen=True, eq=False)
class _Rest:
    """What remains of S: the rows `kept` after those `eliminated` in turn, turned by T (r, r) to its axes."""

    eliminated: tuple[int, ...]
    kept: IntArray
    turned: FloatArray

    def packed(self, S: FloatArray) -> FloatArray:
        """(N, r (r + 1) / 2), of S (N, c, c)."""
        S = S.copy()
        for row in self.eliminated:
            _eliminate(S, row)
        return self.packed_rest(S)

    def packed_rest(self, S: FloatArray) -> FloatArray:
        """The same, of S (N, c, c) after elimination."""
        rows, columns = np.tril_indices(len(self.kept))
        return np.asarray((self.turned.T @ S[:, self.kept[:, None], self.kept] @ self.turned)[:, rows, columns])


def counting(solver: Solver, shape: Shape, poses: Poses, level: float, pool: ThreadPoolExecutor) -> Counting:
    """Made on a box of its own, with more nodes until some of `poses` are counted without doubt.

    Raises NotSmoothError where a part alone has an eigenvalue at the level, or too many nodes would be needed.
    """
    counts = tuple(
        _ROUND if turns else _ACROSS if shape.mirror is not None and k == shape.mirror[0] else _FEWEST
        for k, turns in enumerate(shape.periodic)
    )
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
    S, below = _dual(solver, box.poses(), level, pool)
    rest, negative = _eliminate_steady(box, S)
    nodes = box.unfold(rest.packed_rest(S))
    tails = box.tail(as_frobenius(nodes))
    slack = 2.0 * sum(tails) + _ROUNDING
    return Counting(box, nodes, 0.1 * slack, level, int(below[0]) - negative, len(rest.kept), slack), rest, tails


def _dual(solver: Solver, poses: FloatArray, level: float, pool: ThreadPoolExecutor) -> tuple[FloatArray, IntArray]:
    """S (N, c, c) at poses (N, d), and how many eigenvalues the bodies alone have below the level (N,).

    Raises NotSmoothError where that number changes, or might change in between.
    """

    def at_level(dual: DualSystems) -> tuple[FloatArray, IntArray]:
        if not _keep_away(dual.elements.values(), level):
            raise NotSmoothError("a part alone has a mode near the level")
        return dual.at(level)

    S, below = (np.concatenate(each) for each in zip(*solver.each_dual(poses, at_level, pool), strict=True))
    if np.ptp(below):
        raise NotSmoothError("a part alone has a mode that crosses the level")
    return S, below


def _keep_away(elements: Iterable[Elements], level: float) -> bool:
    """Whether no eigenvalue of a part that follows a travelling contact is near the level in any configuration."""
    changing = [each for each in elements if len(each.mass) > 1]
    near = (level / _AWAY, level * _AWAY)
    counts = [[np.linalg.eigvalsh(each.stiffness - at * each.mass) < 0.0 for at in near] for each in changing]
    return all(np.array_equal(below.sum(axis=1), above.sum(axis=1)) for below, above in counts)


def _eliminate_steady(box: Box, S: FloatArray) -> tuple[_Rest, int]:
    """What remains of S (N, c, c), changed in place, and how many of the pivots were negative; the steadiest first."""
    left = np.arange(S.shape[1])
    eliminated: list[int] = []
    negative = 0
    while len(left):
        changes = _changes(box, S[:, left, left])
        steadiest = int(np.argmin(changes))
        if changes[steadiest] >= _CHANGES:
            break
        row = int(left[steadiest])
        negative += int(S[0, row, row] < 0.0)
        _eliminate(S, row)
        eliminated.append(row)
        left = np.delete(left, steadiest)
    mean = np.mean(S[:, left[:, None], left], axis=0)
    return _Rest(tuple(eliminated), left, _to_ones(mean)), negative


def _eliminate(S: FloatArray, row: int) -> None:
    """One row of S (N, c, c), in place: the Schur complement in those coupled to it, and zeros in its own."""
    beside, pivot = S[:, row].copy(), S[:, row, row].copy()
    beside[:, row] = 0.0
    coupled = np.flatnonzero(np.any(beside, axis=0))
    each = beside[:, coupled]
    S[:, coupled[:, None], coupled] -= each[:, :, None] * (each / pivot[:, None])[:, None, :]
    S[:, row] = 0.0
    S[:, :, row] = 0.0


def _changes(box: Box, values: FloatArray) -> FloatArray:
    """How much each of k values (N, k) at the nodes changes over the box, for its mean: below 1 it is nowhere zero.

    The last terms count for those that are left out. Infinite where the mean has not one sign at all given nodes.
    """
    sizes = box.coefficients(box.unfold(values))
    smooth = tuple(k for k, axis in enumerate(box.axes) if axis.given is None)
    first = tuple(0 if k in smooth else slice(None) for k in range(len(box.axes)))
    mean = sizes[first].reshape(-1, values.shape[1])
    sizes = np.abs(sizes)
    sizes[first] = 0.0
    for k in smooth:
        last = tuple(slice(-_LAST, None) if k == i else slice(None) for i in range(len(box.axes)))
        sizes[last] *= _LEFT_OUT
    changes = sizes.sum(axis=smooth).reshape(-1, values.shape[1])
    one_sign = np.abs(np.sign(mean).sum(axis=0)) == len(mean)
    return np.where(one_sign, (changes / np.where(one_sign, np.abs(mean), 1.0)).max(axis=0), np.inf)


def _to_ones(matrix: FloatArray) -> FloatArray:
    """T (b, b) with eigenvalues 1 and -1 of T^T A T, or near zero where A is singular."""
    scale = 1.0 / np.sqrt(np.maximum(np.linalg.norm(matrix, axis=1), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(matrix * np.outer(scale, scale))
    sizes = np.maximum(np.abs(values), _FLOOR * np.abs(values).max(initial=0.0))
    return np.asarray(scale[:, None] * vectors / np.sqrt(sizes))


def _held_out(
    found: Counting, rest: _Rest, solver: Solver, poses: Poses, pool: ThreadPoolExecutor
) -> tuple[bool, bool]:
    """Of some of the poses: whether what remains of S is within the slack and the count not too small, and whether this
    is exact at most of them."""
    numbers = np.random.default_rng(5).choice(poses.size, min(_HELD_OUT, poses.size), replace=False)
    some = poses.at(np.sort(numbers))
    some = some[solver.machine.kinematics.solve_batch(some).reachable]
    if not len(some):
        return True, True
    S, below = _dual(solver, some, found.level, pool)
    listed = Poses(poses.names, (), some)
    errors = as_frobenius(rest.packed(S) - found.reader(listed)(0, len(some)).T)
    scale = 1.0 / np.sqrt(np.abs(S).max(axis=1))
    spectra = np.linalg.eigvalsh(S * scale[:, :, None] * scale[:, None, :])
    exact, most = below - (spectra < -_ZERO).sum(axis=1), found.at_most(listed)(0, len(some))
    holds = np.all(np.linalg.norm(errors, axis=1) <= found.slack) and np.all((most >= exact) | (most < 0))
    return bool(holds), bool(np.mean(most == exact) > _SURE)
