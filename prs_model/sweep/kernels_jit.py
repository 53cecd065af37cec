"""The same as `kernels`, compiled by numba: cyclic Jacobi and LDL^T on 32 matrices at a time, poses innermost.

A rotation by t in the plane (i, j) makes a_ij zero; a few sweeps over all planes leave the eigenvalues on the diagonal
to rounding (Golub & Van Loan, Matrix Computations, 8.5). Numbers of negative eigenvalues are those of the pivots
(Sylvester).
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_WIDTH = 32
_NARROW = 8  # the same for elimination
_SWEEPS = 12
_PIVOT = 1e-8  # of the largest entry that was met: elimination loses no more digits than that
_CONVERGED = 1e-12  # of the largest diagonal entry, of what is left beside the diagonals


@numba.njit(cache=True, nogil=True, fastmath={"contract", "nnan", "ninf", "nsz", "arcp"})
def eigenvalues(packed: FloatArray, p: int) -> FloatArray:
    """(p, m) ascending."""
    m = packed.shape[1]
    result = np.empty((p, m))
    a = np.zeros((p, p, _WIDTH))
    c, s = np.empty(_WIDTH), np.empty(_WIDTH)
    for start in range(0, m, _WIDTH):
        width = min(_WIDTH, m - start)
        for i in range(p):
            for j in range(i + 1):
                for k in range(width):
                    a[i, j, k] = packed[i * (i + 1) // 2 + j, start + k]
        for _ in range(_SWEEPS):
            largest, beside = 0.0, 0.0
            for i in range(p):
                for k in range(width):
                    largest = max(largest, abs(a[i, i, k]))
                for j in range(i):
                    for k in range(width):
                        beside = max(beside, abs(a[i, j, k]))
            if beside <= _CONVERGED * largest:
                break
            for j in range(p - 1):
                for i in range(j + 1, p):
                    _rotate(a, i, j, p, c, s)
        for k in range(width):
            for i in range(p):  # insertion sort
                value, place = a[i, i, k], i
                while place > 0 and result[place - 1, start + k] > value:
                    result[place, start + k] = result[place - 1, start + k]
                    place -= 1
                result[place, start + k] = value
    return result


@numba.njit(cache=True, nogil=True, fastmath={"contract", "nnan", "ninf", "nsz", "arcp"})
def _rotate(a: FloatArray, i: int, j: int, p: int, c: FloatArray, s: FloatArray) -> None:
    for k in range(_WIDTH):
        off, gap = a[i, j, k], a[i, i, k] - a[j, j, k]
        size = abs(gap) + np.sqrt(gap * gap + 4.0 * off * off) + 1e-300
        t = 2.0 * off / size
        t = -t if gap < 0.0 else t
        c[k] = 1.0 / np.sqrt(1.0 + t * t)
        s[k] = t * c[k]
        a[i, i, k] += t * off
        a[j, j, k] -= t * off
        a[i, j, k] = 0.0
    for row in range(p):
        if row in (i, j):
            continue
        x, y = max(row, i), min(row, i)
        u, v = max(row, j), min(row, j)
        for k in range(_WIDTH):
            at_i, at_j = a[x, y, k], a[u, v, k]
            a[x, y, k] = c[k] * at_i + s[k] * at_j
            a[u, v, k] = c[k] * at_j - s[k] * at_i


@numba.njit(cache=True, nogil=True, error_model="numpy")
def negatives(packed: FloatArray, p: int, slack: float) -> IntArray:
    """Number of eigenvalues below -slack (m,), or -1 where a pivot is too small to tell."""
    m = packed.shape[1]
    result = np.empty(m, dtype=np.int64)
    a = np.ones((p * (p + 1) // 2, _NARROW))
    factor, size = np.empty(_NARROW), np.empty(_NARROW)
    for start in range(0, m, _NARROW):
        width = min(_NARROW, m - start)
        count, sure = np.zeros(_NARROW, dtype=np.int64), np.ones(_NARROW, dtype=np.bool_)
        size[:] = 0.0
        for e in range(len(a)):
            for k in range(width):
                a[e, k] = packed[e, start + k]
                size[k] = max(size[k], abs(a[e, k]))
        for j in range(p):
            for k in range(width):
                a[j * (j + 3) // 2, k] += slack
        for j in range(p):
            diagonal = j * (j + 3) // 2
            for k in range(width):
                count[k] += a[diagonal, k] < 0.0
                sure[k] &= abs(a[diagonal, k]) > _PIVOT * size[k]
            for i in range(j + 1, p):
                row = i * (i + 1) // 2
                for k in range(_NARROW):
                    factor[k] = a[row + j, k] / a[diagonal, k]
                    size[k] = max(size[k], abs(a[row + j, k]))
                for h in range(j + 1, i + 1):
                    below = h * (h + 1) // 2 + j
                    for k in range(_NARROW):
                        a[row + h, k] -= factor[k] * a[below, k]
        for k in range(width):
            result[start + k] = count[k] if sure[k] else -1
    return result
