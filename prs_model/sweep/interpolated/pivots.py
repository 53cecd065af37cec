"""Elimination of S at many poses at once: as far as pivots are nowhere zero, its outcome is known for all of them.

With coefficients c_k of terms t_k, none of which exceeds one, a pivot

    c_0 + sum c_k t_k(x),   sum |c_k| < |c_0|,

has the sign of c_0 at every pose x. The steadiest comes first. S is taken a little softer than it is, so that rigid
joints which hold a motion twice do not make it singular: that can but raise the number of modes below a level.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray, IntArray
from .spectral import LAST, Box

_CHANGES = 0.7  # of a pivot that is eliminated, at most: well away from zero, it leaves smooth what remains
_LEFT_OUT = 3.0  # times that the last terms along an axis count, for those left out
_SOFT = 1e-9  # of the diagonal of S, added to it
_FLOOR = 1e-9  # of the largest eigenvalue of what remains


@dataclass(frozen=True, eq=False)
class Rest:
    """What remains of S: the rows `kept` after those `eliminated` in turn, turned by T (r, r) to its axes."""

    eliminated: tuple[int, ...]
    kept: IntArray
    turned: FloatArray

    def packed(self, S: FloatArray) -> FloatArray:
        """(N, r (r + 1) / 2), of S (N, c, c)."""
        S = _softened(S)
        for row in self.eliminated:
            _eliminate(S, row)
        return self._packed(S)

    def _packed(self, S: FloatArray) -> FloatArray:
        rows, columns = np.tril_indices(len(self.kept))
        return np.asarray((self.turned.T @ S[:, self.kept[:, None], self.kept] @ self.turned)[:, rows, columns])

    @classmethod
    def at_nodes(cls, box: Box, S: FloatArray) -> tuple[Rest, FloatArray, int]:
        """What remains of S (N, c, c) at the nodes of a box, packed; and how many of the pivots were negative."""
        S, left = _softened(S), np.arange(S.shape[1])
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
        rest = cls(tuple(eliminated), left, _to_ones(np.mean(S[:, left[:, None], left], axis=0)))
        return rest, rest._packed(S), negative


def _softened(S: FloatArray) -> FloatArray:
    """A copy of S (N, c, c), its diagonal raised a little."""
    softened, rows = S.copy(), np.arange(S.shape[1])
    softened[:, rows, rows] += _SOFT * np.abs(S[:, rows, rows])
    return softened


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
        last = slice(-LAST[box.axes[k].kind], None)
        sizes[tuple(last if k == i else slice(None) for i in range(len(box.axes)))] *= _LEFT_OUT
    changes = sizes.sum(axis=smooth).reshape(-1, values.shape[1])
    one_sign = np.abs(np.sign(mean).sum(axis=0)) == len(mean)
    return np.where(one_sign, (changes / np.where(one_sign, np.abs(mean), 1.0)).max(axis=0), np.inf)


def _to_ones(matrix: FloatArray) -> FloatArray:
    """T (b, b) with eigenvalues 1 and -1 of T^T A T, or near zero where A is singular."""
    scale = 1.0 / np.sqrt(np.maximum(np.linalg.norm(matrix, axis=1), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(matrix * np.outer(scale, scale))
    sizes = np.maximum(np.abs(values), _FLOOR * np.abs(values).max(initial=0.0))
    return np.asarray(scale[:, None] * vectors / np.sqrt(sizes))
