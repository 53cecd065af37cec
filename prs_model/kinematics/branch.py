"""Staying on the reference configuration's assembly branch.

A parallel machine reaches most poses in several ways. Two of them are separated by a singular configuration; the
right one is that to which the reference can be moved without passing one. Newton from the reference finds it nearly
always; where there is doubt, the pose is approached in small steps instead, and that result counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import BoolArray, FloatArray
from .equations import Equations
from .newton import newton

_LEAST_AGREEMENT = 1e-2  # with the reference, below which a solution is doubted
_LARGEST_TURN = np.pi / 2  # of one joint from the reference, above which a solution is doubted
_FIRST_STEP, _SMALLEST_STEP = 0.25, 2.0**-10  # shares of the way from the reference
_LONGEST_MOVE = 0.3  # of one joint in one step [m, rad]
_LEAST_STEP_AGREEMENT = 0.1


def agreement(before: FloatArray, after: FloatArray) -> FloatArray:
    """det(J0^T J) / det(J0^T J0) of Jacobians J0 (..., m, n) and J (N, m, n): 1 if equal, 0 at a singularity, then < 0.

    Its sign is the side of the singularity. It needs no choice of independent rows.
    """
    back = np.swapaxes(before, -1, -2)
    sign, size = np.linalg.slogdet(back @ after)
    _, scale = np.linalg.slogdet(back @ before)
    return np.asarray(sign * np.exp(np.minimum(size - scale, 50.0)))


@dataclass(frozen=True)
class Branch:
    """The reference configuration: joint values (n,) and the targets (t,) they reach."""

    equations: Equations
    q: FloatArray
    targets: FloatArray

    def settle(self, q: FloatArray, solved: BoolArray, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Check Newton's results (N, n) and replace the doubtful ones by continuation.

        Returns joint values (N, n), and the share of the way from the reference for which they were found (N,): 1 for a
        solution on the reference's branch.
        """
        doubtful = np.flatnonzero(~solved | self._in_doubt(q, solved, targets))
        q, share = q.copy(), np.ones(len(q))
        if doubtful.size:
            q[doubtful], share[doubtful] = self.follow(targets[doubtful])
        return q, share

    def _in_doubt(self, q: FloatArray, solved: BoolArray, targets: FloatArray) -> BoolArray:
        likeness = agreement(self._reference_jacobian, self._jacobian(q[solved], targets[solved]))
        turns = np.abs(q[solved] - self.q) * self.equations.tree.revolute
        doubt = np.zeros(len(q), dtype=bool)
        doubt[solved] = (likeness < _LEAST_AGREEMENT) | (np.max(turns, axis=1, initial=0.0) > _LARGEST_TURN)
        return doubt

    @cached_property
    def _reference_jacobian(self) -> FloatArray:
        return np.asarray(self._jacobian(self.q[None], self.targets[None])[0])

    def follow(self, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Move from the reference to targets (N, t) in small steps.

        A step is halved where Newton fails, a joint jumps or a singularity is near. Returns the last joint values
        (N, n) and the share of the way made (N,): 1 if the target is reached.
        """
        count = len(targets)
        q, share, step = np.tile(self.q, (count, 1)), np.zeros(count), np.full(count, _FIRST_STEP)
        while (under_way := np.flatnonzero((share < 1.0) & (step >= _SMALLEST_STEP))).size:
            ahead = np.minimum(share[under_way] + step[under_way], 1.0)
            trial, kept = self._step(q[under_way], share[under_way], ahead, targets[under_way])
            moved = under_way[kept]
            q[moved], share[moved] = trial[kept], ahead[kept]
            step[under_way] *= np.where(kept, 2.0, 0.5)
        return q, share

    def _step(
        self, q: FloatArray, share: FloatArray, ahead: FloatArray, targets: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        trial, kept = newton(self.equations, q, self._on_the_way(ahead, targets), iterations=8)
        kept &= np.max(np.abs(trial - q), axis=1, initial=0.0) <= _LONGEST_MOVE
        here = self._jacobian(q, self._on_the_way(share, targets))
        there = self._jacobian(trial, self._on_the_way(ahead, targets))
        return trial, kept & (agreement(here, there) > _LEAST_STEP_AGREEMENT)

    def _on_the_way(self, share: FloatArray, targets: FloatArray) -> FloatArray:
        return self.targets + share[:, None] * (targets - self.targets)

    def _jacobian(self, q: FloatArray, targets: FloatArray) -> FloatArray:
        return self.equations.jacobian(self.equations.tree.forward(q), targets)
