"""Exact elimination of rigid joint directions: a basis of the null space that keeps physical coordinates."""

from __future__ import annotations

import numpy as np
from scipy.linalg import qr, solve_triangular

from ..arrays import FloatArray, IntArray

_RANK_TOLERANCE = 1e-9


def independent_coordinates(constraints: FloatArray) -> tuple[FloatArray, IntArray]:
    """Solve G u = 0 for the dependent coordinates.

    Returns the expansion T (n, m) with u = T u[kept] and G T = 0, and the kept coordinates (m,) in ascending
    order. Rows of G (r, n) may be redundant. The dependent ones are chosen by QR with column pivoting.
    """
    n = constraints.shape[1]
    if constraints.shape[0] == 0:
        return np.eye(n), np.arange(n)
    norms = np.linalg.norm(constraints, axis=1, keepdims=True)
    scaled = constraints / np.where(norms > 0, norms, 1.0)
    _, triangle, order = qr(scaled, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    rank = int(np.sum(diagonal > _RANK_TOLERANCE * diagonal[0])) if diagonal[0] > 0 else 0
    dependent, kept = order[:rank], np.sort(order[rank:])
    position = np.empty(n, dtype=np.intp)
    position[kept] = np.arange(n - rank)
    expansion = np.zeros((n, n - rank))
    expansion[kept, position[kept]] = 1.0
    solved = solve_triangular(triangle[:rank, :rank], triangle[:rank, rank:])
    expansion[np.ix_(dependent, position[order[rank:]])] = -solved
    return expansion, kept.astype(np.intp)
