"""How many eigenvalues lie below a level at every pose, so that no mode is missed.

S of the dual assembly (see `synthesis.dual`) tells it. Its entries hold what every part and joint does, and are as
smooth in the pose as the joints' values are: a mode cannot hide between the nodes of its interpolant, as it might
between those of the modes themselves. At each pose the eigenvalues are counted by LDL^T of S + d, where d is more than
the interpolant may be off, so that the count is never too small.

What can be eliminated of S once for all poses is (see `pivots`); often no row is left, and the number is the same all
over the box. What is left otherwise is interpolated and counted at every pose.

That S is as smooth as its nodes make believe is tested on the joints' values, from which all of it follows, at very
many poses, and on S itself at a few.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from .. import kernels as plain
from ..exact import Solver, part
from ..kernels import as_frobenius
from ..not_smooth import NotSmoothError
from ..poses import Poses
from .box_of import Shape
from .joint_values import joint_values
from .pivots import Rest
from .spectral import Box
from .tensor import Tensor

Counter = Callable[[int, int], IntArray]

_FEWEST, _ROUND, _ACROSS = 6, 17, 10  # nodes to begin with: along an axis, a periodic one, one that is mirrored
_ENLARGED = 1.4
_MOST = 2500  # nodes
_SLACK = 0.2  # allowed, of what remains of S, whose eigenvalues are about 1 and -1
_SHARPEST = 1e-6  # of the same, below which it is not made smaller
_ROUNDING = 2e-7
_FEW = 8  # poses at which counts are tried
_SURE = 0.9  # share of the few poses


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


def counting(solver: Solver, shape: Shape, poses: Poses, level: float, pool: ThreadPoolExecutor) -> Counting:
    """Made on a box of its own, with more nodes until some of `poses` are counted rightly and without doubt.

    Raises NotSmoothError where too many nodes would be needed, LinAlgError where a part alone has a mode at the level.
    """
    counts = tuple(
        _ROUND if turns else _ACROSS if shape.mirror is not None and k == shape.mirror[0] else _FEWEST
        for k, turns in enumerate(shape.periodic)
    )
    kinematics = solver.machine.kinematics
    joints = joint_values(kinematics, poses)
    trials = _trials(solver, joints.poses, level, pool)
    wanted, best = _SLACK, None
    while len((box := shape.box(counts)).solved) <= min(_MOST, poses.size / 2):
        found, rest, tails = _on(box, solver, level, pool)
        at_nodes = kinematics.solve_batch(box.poses()).q
        if found.slack <= wanted and joints.are_met_by(box, at_nodes) and trials.hold(found, rest):
            if found.slack <= _SHARPEST or trials.are_told_by(found):
                return found
            wanted, best = 0.1 * found.slack, found
        grown = tuple(
            int(np.ceil(count * _ENLARGED)) if tail >= 0.2 * max(tails) else count
            for count, tail in zip(box.shape, tails, strict=True)
        )
        if shape.box(grown).shape == box.shape:
            break
        counts = grown
    if best is None:
        raise NotSmoothError(f"{len(box.solved)} nodes do not suffice to count modes")
    return best


def _on(box: Box, solver: Solver, level: float, pool: ThreadPoolExecutor) -> tuple[Counting, Rest, tuple[float, ...]]:
    """With the nodes of a box; what remains of S; and its error that is due to each axis."""
    S, below = _dual(solver, box.poses(), level, pool)
    rest, remains, negative = Rest.at_nodes(box, S)
    nodes = box.unfold(remains)
    tails = box.tail(as_frobenius(nodes))
    slack = 2.0 * sum(tails) + _ROUNDING
    return Counting(box, nodes, 0.1 * slack, level, int(below[0]) - negative, len(rest.kept), slack), rest, tails


def _dual(solver: Solver, poses: FloatArray, level: float, pool: ThreadPoolExecutor) -> tuple[FloatArray, IntArray]:
    """S (N, c, c) at poses (N, d), and how many eigenvalues the bodies alone have below the level (N,)."""
    chunks = list(solver.each_dual(poses, lambda dual: dual.at(level, keeping=True), pool))
    S, below = (np.concatenate(each) for each in zip(*chunks, strict=True))
    return S, below


@dataclass(frozen=True, eq=False)
class _Trials:
    """Some poses with S (n, c, c) and the exact counts (n,)."""

    poses: Poses
    S: FloatArray
    exact: IntArray

    def hold(self, found: Counting, rest: Rest) -> bool:
        """Whether what remains of S is within the slack, and no count too small."""
        errors = as_frobenius(rest.packed(self.S) - found.reader(self.poses)(0, self.poses.size).T)
        most = found.at_most(self.poses)(0, self.poses.size)
        return bool(np.all(np.linalg.norm(errors, axis=1) <= found.slack) and np.all((most >= self.exact) | (most < 0)))

    def are_told_by(self, found: Counting) -> bool:
        """Whether nearly all counts are exact."""
        return bool(np.mean(found.at_most(self.poses)(0, self.poses.size) == self.exact) > _SURE)


def _trials(solver: Solver, poses: Poses, level: float, pool: ThreadPoolExecutor) -> _Trials:
    """Some of the poses, and both ends, all within reach; the exact counts are those of K - l M, not of S."""
    drawn = np.random.default_rng(5).choice(poses.size, min(_FEW, poses.size), replace=False)
    ends = np.arange(min(_FEW // 2, poses.size))
    some = poses.at(np.unique([*drawn, *ends, *(poses.size - 1 - ends)]))
    found = solver.machine.kinematics.solve_batch(some)
    pencils = solver.systems(part(found, slice(None))).pencils
    exact = [_negative(stiffness - level * mass, np.diag(stiffness)) for mass, stiffness, _ in pencils]
    return _Trials(Poses(poses.names, (), some), _dual(solver, some, level, pool)[0], np.array(exact))


def _negative(matrix: FloatArray, sizes: FloatArray) -> int:
    scale = 1.0 / np.sqrt(np.where(sizes > 0.0, sizes, 1.0))
    return int((np.linalg.eigvalsh(matrix * np.outer(scale, scale)) < 0.0).sum())
