"""Small dense matrices by plain loops, compiled by numba."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

uint: Any = numba.uintp  # an index without sign never counts from the end, and loops become vector instructions

PIVOT = 1e-7  # of what it is the difference of: elimination loses no more digits than that


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def ritz_vectors(upper: FloatArray, mass: FloatArray, count: int) -> FloatArray:
    """Those with the largest Ritz values mu, times 1 / mu (r, count)."""
    r = uint(len(mass))
    factor, full = np.empty((len(mass), len(mass))), np.empty((len(mass), len(mass)))
    copy(mass, factor)
    factorised(factor)
    for i in range(r):
        for c in range(i, r):
            full[i, c] = full[c, i] = upper[i, c]
    solved(factor, full)
    for i in range(r):
        for c in range(i):
            full[i, c], full[c, i] = full[c, i], full[i, c]
    solved(factor, full)
    values, vectors = np.linalg.eigh(full)
    some = np.empty((len(mass), count))
    for i in range(len(mass) - 1, -1, -1):
        for c in range(count):
            some[i, c] = vectors[i, len(mass) - 1 - c] / values[len(mass) - 1 - c]
        for j in range(uint(i + 1), r):
            for c in range(uint(count)):
                some[i, c] -= factor[i, j] * some[j, c]
        for c in range(count):
            some[i, c] /= factor[i, i]
    return some


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def factorised(a: FloatArray) -> None:
    """U of U^T U, in place of an upper triangle."""
    r = uint(len(a))
    for k in range(r):
        root = np.sqrt(a[k, k])
        for c in range(k, r):
            a[k, c] /= root
        for i in range(uint(k + 1), r):
            for c in range(i, r):
                a[i, c] -= a[k, i] * a[k, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def solved(factor: FloatArray, b: FloatArray) -> None:
    """U^-T b, in place of b."""
    r = uint(len(b))
    for k in range(r):
        for c in range(r):
            b[k, c] /= factor[k, k]
        for i in range(uint(k + 1), r):
            for c in range(r):
                b[i, c] -= factor[k, i] * b[k, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def largest(sizes: IntArray, which: int) -> int:
    largest = 0
    for b in range(len(sizes)):
        largest = max(largest, sizes[b, which])
    return largest


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def copy(source: FloatArray, result: FloatArray) -> None:
    for i in range(len(source)):
        for c in range(source.shape[1]):
            result[i, c] = source[i, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def fill(result: FloatArray, rows: int, columns: int) -> None:
    """Zeros."""
    for i in range(rows):
        for c in range(columns):
            result[i, c] = 0.0


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def products(x: FloatArray, w: FloatArray, n: int, first: int, last: int, width: int, result: FloatArray) -> None:
    """Adds x^T diag(w) x to rows first .. last of an upper triangle, from four rows of x at a time."""
    for i in range(first, last):
        for j in range(0, n - n % 4, 4):
            f, g, h, e = w[j] * x[j, i], w[j + 1] * x[j + 1, i], w[j + 2] * x[j + 2, i], w[j + 3] * x[j + 3, i]
            for c in range(uint(i), uint(width)):
                result[i, c] += f * x[j, c] + g * x[j + 1, c] + h * x[j + 2, c] + e * x[j + 3, c]
        for j in range(n - n % 4, n):
            f = w[j] * x[j, i]
            for c in range(uint(i), uint(width)):
                result[i, c] += f * x[j, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def eliminated(a: FloatArray, x: FloatArray, n: int, width: int, scale: FloatArray) -> tuple[int, bool]:
    """L D L^T of the upper triangle of a (n, n), L^-1 x; how many pivots are negative, and whether that is sure."""
    negative, sure = 0, True
    for i in range(n):
        scale[i] = abs(a[i, i])
    for j in range(n):
        pivot = a[j, j]
        negative += pivot < 0.0
        sure = sure and abs(pivot) > PIVOT * scale[j]
        for i in range(j + 1, n):
            factor = a[j, i] / pivot
            scale[i] += abs(factor * a[j, i])
            for c in range(uint(i), uint(n)):
                a[i, c] -= factor * a[j, c]
            for c in range(uint(0), uint(width)):
                x[i, c] -= factor * x[j, c]
    return negative, sure
