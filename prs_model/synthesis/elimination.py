"""Exact elimination of rigid joint directions: a basis of the null space that keeps physical coordinates."""

from __future__ import annotations

import numpy as np
from scipy.linalg import qr, solve_triangular

from ..arrays import FloatArray, IntArray

_RANK_TOLERANCE = 1e-9
_ROUND_OFF = 1e-10


def independent_coordinates(constraints: FloatArray, sizes: FloatArray) -> tuple[FloatArray, IntArray]:
    """Solve G u = 0 for the dependent coordinates.

    Returns the expansion T (n, m) with u = T u[kept] and G T = 0, and the kept coordinates (m,) in ascending
    order. Rows of G (r, n) may be redundant; one whose norm is round-off beside its `size` (r,), the norm of what was
    subtracted in it, constrains nothing. The dependent coordinates are chosen by QR with column pivoting.
    """
    n = constraints.shape[1]
    norms = np.linalg.norm(constraints, axis=1)
    real = norms > _ROUND_OFF * sizes
    if not real.any():
        return np.eye(n), np.arange(n)
    _, triangle, order = qr(constraints[real] / norms[real, None], mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    rank = int(np.sum(diagonal > _RANK_TOLERANCE * diagonal[0]))
    dependent, kept = order[:rank], np.sort(order[rank:])
    position = np.empty(n, dtype=np.intp)
    position[kept] = np.arange(n - rank)
    expansion = np.zeros((n, n - rank))
    expansion[kept, position[kept]] = 1.0
    solved = solve_triangular(triangle[:rank, :rank], triangle[:rank, rank:])
    expansion[np.ix_(dependent, position[order[rank:]])] = -solved
    return expansion, kept.astype(np.intp)
