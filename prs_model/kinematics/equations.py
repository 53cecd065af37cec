"""The equations of a closed machine: its loops and its task, on the joint values of the open tree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..description import schema
from . import kernels
from .tasks import Task
from .tree import Frames, Tree


@dataclass(frozen=True)
class Pair:
    """Frame b seen from frame a; `moves` (n,) is 1 where a joint moves b alone, -1 where it moves a alone."""

    a: str
    b: str
    moves: FloatArray


@dataclass(frozen=True)
class Loop:
    """A closure: two links that coincide (6 rows) or whose origins do (3 rows)."""

    name: str
    pair: Pair
    rows: int


@dataclass(frozen=True)
class Equations:
    """Closure and task residuals [m, rad] and their Jacobian.

    A closure's rows are the position of b in a and the rotation vector of b relative to a. The Jacobian is exact off
    the closure too.
    """

    tree: Tree
    loops: tuple[Loop, ...]
    task: Task
    tool: Pair

    @property
    def loop_rows(self) -> int:
        """Number of closure rows; task rows follow them."""
        return sum(loop.rows for loop in self.loops)

    def residual(self, frames: Frames, targets: FloatArray) -> FloatArray:
        """Closure rows, then task rows (N, m)."""
        task = self.task.residual(*self._relative(self.tool, frames), targets)
        return np.concatenate([self.closure_residual(frames), task], axis=1)

    def closure_residual(self, frames: Frames) -> FloatArray:
        """Closure rows (N, c)."""
        rows = [np.zeros((len(frames.positions), 0))]
        for loop in self.loops:
            R, p = self._relative(loop.pair, frames)
            rows += [p] if loop.rows == 3 else [p, kernels.rotation_vector(R)]
        return np.concatenate(rows, axis=1)

    def jacobian(self, frames: Frames, targets: FloatArray) -> FloatArray:
        """Derivative of `residual` (N, m, n)."""
        rows = [self._loop_jacobian(loop, frames) for loop in self.loops]
        R, p = self._relative(self.tool, frames)
        rows.append(self.task.jacobian(R, p, self._velocity(self.tool, frames), targets))
        return np.concatenate(rows, axis=1)

    def _loop_jacobian(self, loop: Loop, frames: Frames) -> FloatArray:
        velocity = self._velocity(loop.pair, frames)
        if loop.rows == 3:
            return velocity[:, :3]
        R, _ = self._relative(loop.pair, frames)
        turning = kernels.inverse_left_jacobian(kernels.rotation_vector(R)) @ velocity[:, 3:]
        return np.concatenate([velocity[:, :3], turning], axis=1)

    def _relative(self, pair: Pair, frames: Frames) -> tuple[FloatArray, FloatArray]:
        return kernels.relative_frame(*self.tree.link_frame(frames, pair.a), *self.tree.link_frame(frames, pair.b))

    def _velocity(self, pair: Pair, frames: Frames) -> FloatArray:
        R_a, _ = self.tree.link_frame(frames, pair.a)
        _, p_b = self.tree.link_frame(frames, pair.b)
        return kernels.relative_jacobian(
            frames.rotations, frames.positions, self.tree.axes, self.tree.revolute, pair.moves, R_a, p_b
        )


def set_up(tree: Tree, closures: Mapping[str, schema.Closure], task: Task, tool: str, measured_in: str) -> Equations:
    """The equations of a machine. Raises UnknownNameError for a link that is not in the tree."""
    loops = tuple(
        Loop(name, _pair(tree, *closure.between), 6 if closure.kind == "frame" else 3)
        for name, closure in closures.items()
    )
    return Equations(tree, loops, task, _pair(tree, measured_in, tool))


def _pair(tree: Tree, a: str, b: str) -> Pair:
    moves_a, moves_b = (tree.ancestry[tree.link(name).carrier].astype(float) for name in (a, b))
    return Pair(a, b, moves_b - moves_a)
