"""The same as `kernels_ritz`, compiled by numba: pose by pose, all that belongs to one stays in the cache.

Pivots are not chosen. Below all eigenvalues none is small; elsewhere one that is, beside what it is the difference of,
makes the count doubtful.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

uint: Any = numba.uintp  # an index without sign never counts from the end, and loops become vector instructions

_WIDTH = 8  # columns that are improved at a time
_PIVOT = 1e-7  # of what it is the difference of: elimination loses no more digits than that


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def below(packed: Any) -> tuple[IntArray, BoolArray]:
    """How many eigenvalues lie below the shift (N,), and whether that is sure (N,)."""
    count, r, whole = len(packed.readings), len(packed.mass), len(packed.constant)
    number, sure = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.bool_)
    many, n = len(packed.sizes), packed.sizes[:, 1].max()
    x, pencils = np.empty((many, n, packed.sizes[:, 0].max() + r)), np.empty((many, n, n))
    a, mass, d, scale = np.empty((whole, whole)), np.empty((r, r)), np.empty((many, n)), np.empty(whole + n)
    for p in range(count):
        negative, certain = _assembled(packed, p, a, mass, x, pencils, d, scale)
        ours, fine = _condensed(packed, a, scale)
        number[p], sure[p] = negative - ours, certain and fine
    return number, sure


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def moments(packed: Any, count: int) -> FloatArray:
    """(N, 3, count, count): X^T M T^k X with k = 2, 3, 4 and T = (K - s M)^-1 M, of the Ritz vectors X of T on V with
    the largest Ritz values mu, as columns of X diag(1 / mu)."""
    r, whole = len(packed.mass), len(packed.constant)
    size, many, most = whole - r, len(packed.sizes), packed.sizes[:, 1].max()
    result = np.empty((len(packed.readings), 3, count, count))
    x, pencils = np.empty((many, most, packed.sizes[:, 0].max() + r)), np.empty((many, most, most))
    a, mass, d, scale = np.empty((whole, whole)), np.empty((r, r)), np.empty((many, most)), np.empty(whole + most)
    blocks, wrenches = -(-count // _WIDTH), np.empty((size, _WIDTH))
    shape = (blocks, many, most, _WIDTH)
    loads, once, further, twice = np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for p in range(len(result)):
        _assembled(packed, p, a, mass, x, pencils, d, scale)
        _condensed(packed, a, scale)
        chosen = _ritz_vectors(a[size:, size:], mass, count)
        for e in range(blocks):
            _loads(packed, x, chosen, e * _WIDTH, loads[e])
            _applied(packed, a, x, d, loads[e], wrenches, once[e])
            _momenta(packed, p, pencils, d, once[e], loads[e])
            _applied(packed, a, x, d, loads[e], wrenches, twice[e])
            _momenta(packed, p, pencils, d, twice[e], further[e])
        for i in range(count):
            for j in range(count):
                result[p, 0, i, j] = _together(packed, once, loads, i, j)
                result[p, 1, i, j] = _together(packed, twice, loads, i, j)
                result[p, 2, i, j] = _together(packed, twice, further, i, j)
    return result


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _ritz_vectors(upper: FloatArray, mass: FloatArray, count: int) -> FloatArray:
    """Those with the largest Ritz values mu, times 1 / mu (r, count)."""
    r = len(mass)
    full, product = upper + np.triu(upper, 1).T, mass + np.triu(mass, 1).T
    root = np.linalg.inv(np.linalg.cholesky(product))
    values, vectors = np.linalg.eigh(root @ full @ root.T)
    some = np.empty((r, count))
    for c in range(count):
        some[:, c] = vectors[:, r - 1 - c] / values[r - 1 - c]
    return root.T @ some


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _loads(packed: Any, x: FloatArray, chosen: FloatArray, first: int, result: FloatArray) -> None:
    """X^T M V of each body times columns first, .. of those chosen (r, p); zero beyond them."""
    wide = min(_WIDTH, chosen.shape[1] - first)
    for b in range(len(packed.sizes)):
        k, n, _ = packed.sizes[b]
        for i in range(n):
            result[b, i] = 0.0
            for j in range(len(chosen)):
                factor = x[b, i, k + j]
                for c in range(wide):
                    result[b, i, c] += factor * chosen[j, first + c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _together(packed: Any, a: FloatArray, b: FloatArray, i: int, j: int) -> float:
    """Sum over all bodies of column i of one times column j of the other."""
    total = 0.0
    for body in range(len(packed.sizes)):
        for k in range(packed.sizes[body, 1]):
            total += a[i // _WIDTH, body, k, i % _WIDTH] * b[j // _WIDTH, body, k, j % _WIDTH]
    return total


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _applied(
    packed: Any,
    a: FloatArray,
    x: FloatArray,
    d: FloatArray,
    loads: FloatArray,
    wrenches: FloatArray,
    result: FloatArray,
) -> None:
    """(K - s M)^-1 of loads (b, n, width), of each body and on its coordinates X."""
    wide, size = uint(_WIDTH), len(wrenches)
    wrenches[:] = 0.0
    rows = 0
    for b in range(len(packed.sizes)):
        k, n, _ = packed.sizes[b]
        for j in range(n):
            for i in range(k):
                row, factor = packed.rows[rows + i], x[b, j, i] / d[b, j]
                for c in range(wide):
                    wrenches[row, c] += factor * loads[b, j, c]
        rows += k
    for j in range(size):
        for i in packed.columns[packed.starts[j] : packed.starts[j + 1]]:
            factor = a[j, i] / a[j, j]
            for c in range(wide):
                wrenches[i, c] -= factor * wrenches[j, c]
    for j in range(size - 1, -1, -1):
        for i in packed.columns[packed.starts[j] : packed.starts[j + 1]]:
            for c in range(wide):
                wrenches[j, c] -= a[j, i] * wrenches[i, c]
        for c in range(wide):
            wrenches[j, c] /= a[j, j]
    rows = 0
    for b in range(len(packed.sizes)):
        k, n, _ = packed.sizes[b]
        result[b, :n] = loads[b, :n]
        for i in range(k):
            row = packed.rows[rows + i]
            for j in range(n):
                factor = x[b, j, i]
                for c in range(wide):
                    result[b, j, c] -= factor * wrenches[row, c]
        for j in range(n):
            for c in range(wide):
                result[b, j, c] /= d[b, j]
        rows += k


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _momenta(packed: Any, p: int, pencils: FloatArray, d: FloatArray, shapes: FloatArray, result: FloatArray) -> None:
    """X^T M X of shapes (b, n, width) on the coordinates X; of a body that follows the pose X is L^-T."""
    wide = uint(_WIDTH)
    moving, diagonals = 0, 0
    for b in range(len(packed.sizes)):
        _, n, follows = packed.sizes[b]
        if not follows:
            for i in range(n):
                for c in range(wide):
                    result[b, i, c] = packed.inertias[diagonals + i] * shapes[b, i, c]
            diagonals += n
            continue
        own, physical = packed.masses[p, moving : moving + n * n].reshape(n, n), shapes[b, :n].copy()
        moving += n * n
        for j in range(n - 1, -1, -1):
            for i in range(j + 1, n):
                factor = pencils[b, j, i] / d[b, j]
                for c in range(wide):
                    physical[j, c] -= factor * physical[i, c]
        for i in range(n):
            result[b, i] = 0.0
            for j in range(n):
                factor = own[i, j]
                for c in range(wide):
                    result[b, i, c] += factor * physical[j, c]
        for j in range(n):
            for i in range(j + 1, n):
                factor = pencils[b, j, i] / d[b, j]
                for c in range(wide):
                    result[b, i, c] -= factor * result[b, j, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _assembled(
    packed: Any,
    p: int,
    a: FloatArray,
    mass: FloatArray,
    x: FloatArray,
    pencils: FloatArray,
    d: FloatArray,
    scale: FloatArray,
) -> tuple[int, bool]:
    """Upper triangles of [[S, g], [g^T, G_0]] and of V^T M V at pose p; X^T [B^T, M V] and d of each body.

    Returns how many eigenvalues of the bodies lie below the shift, and whether that is sure.
    """
    r = uint(len(mass))
    size = uint(len(a)) - r
    a[:] = packed.constant
    mass[:] = packed.mass
    for e in range(len(packed.entries)):
        a[packed.entries[e, 0], packed.entries[e, 1]] += packed.values[p, e]
    number, fine = packed.below, True
    rows, readings, fixed, moving, diagonals, loads, shapes = 0, 0, 0, 0, 0, 0, 0
    added = np.empty((x.shape[2], x.shape[2]))
    for b in range(len(packed.sizes)):
        k, n, follows = packed.sizes[b]
        width = k + len(mass)
        forces = packed.readings[p, readings : readings + n * k].reshape(n, k)
        readings += n * k
        if follows:
            own = packed.masses[p, moving : moving + n * n].reshape(n, n)
            pencils[b, :n, :n] = packed.pencils[p, moving : moving + n * n].reshape(n, n)
            shape = packed.shapes[shapes : shapes + n * len(mass)].reshape(n, len(mass))
            _beside(own, shape, forces, x[b], mass)
            negative, certain = _eliminated(pencils[b], x[b], n, width, scale)
            number, fine = number + negative, fine and certain
            for i in range(n):
                d[b, i] = pencils[b, i, i]
            moving += n * n
            shapes += n * len(mass)
        else:
            root = packed.roots[fixed : fixed + n * n].reshape(n, n)
            load = packed.loads[loads : loads + n * len(mass)].reshape(n, len(mass))
            _turned(root, forces, load, x[b])
            d[b, :n] = packed.pivots[diagonals : diagonals + n]
            fixed += n * n
            loads += n * len(mass)
            diagonals += n
        last = width if follows else k
        added[:last, :width] = 0.0
        scale[:n] = 1.0 / d[b, :n]
        _products(x[b], scale, n, 0, last, width, added)
        for i in range(k):
            row = packed.rows[rows + i]
            for j in range(i, k):
                a[row, packed.rows[rows + j]] += added[i, j]
            for c in range(r):
                a[row, size + c] += added[i, uint(k) + c]
        for i in range(k, last):
            for c in range(uint(i - k), r):
                a[size + uint(i - k), size + c] += added[i, uint(k) + c]
        rows += k
    return number, fine


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _beside(own: FloatArray, shape: FloatArray, forces: FloatArray, x: FloatArray, mass: FloatArray) -> None:
    """[B^T, M V] of a body that follows the pose, and its part of V^T M V."""
    n, k, r = len(own), forces.shape[1], shape.shape[1]
    for i in range(n):
        x[i, :k] = forces[i]
        x[i, k : k + r] = 0.0
        for j in range(n):
            factor = own[i, j]
            for c in range(uint(0), uint(r)):
                x[i, k + c] += factor * shape[j, c]
        for j in range(r):
            factor = shape[i, j]
            for c in range(uint(j), uint(r)):
                mass[j, c] += factor * x[i, k + c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _turned(root: FloatArray, forces: FloatArray, load: FloatArray, x: FloatArray) -> None:
    """X^T [B^T, M V] of a body that is the same at all poses."""
    n, k, r = len(root), forces.shape[1], load.shape[1]
    for i in range(n):
        x[i, :k] = 0.0
        x[i, k : k + r] = load[i]
        for j in range(n):
            factor = root[i, j]
            for c in range(uint(0), uint(k)):
                x[i, c] += factor * forces[j, c]


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _products(x: FloatArray, w: FloatArray, n: int, first: int, last: int, width: int, result: FloatArray) -> None:
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
def _eliminated(a: FloatArray, x: FloatArray, n: int, width: int, scale: FloatArray) -> tuple[int, bool]:
    """L D L^T of the upper triangle of a (n, n), L^-1 x; how many pivots are negative, and whether that is sure."""
    negative, sure = 0, True
    for i in range(n):
        scale[i] = abs(a[i, i])
    for j in range(n):
        pivot = a[j, j]
        negative += pivot < 0.0
        sure = sure and abs(pivot) > _PIVOT * scale[j]
        for i in range(j + 1, n):
            factor = a[j, i] / pivot
            scale[i] += abs(factor * a[j, i])
            for c in range(uint(i), uint(n)):
                a[i, c] -= factor * a[j, c]
            for c in range(uint(0), uint(width)):
                x[i, c] -= factor * x[j, c]
    return negative, sure


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _condensed(packed: Any, a: FloatArray, scale: FloatArray) -> tuple[int, bool]:
    """The same of S, which leaves A in the last rows: as told by the fill."""
    whole = len(a)
    size = whole - len(packed.mass)
    negative, sure = 0, True
    for i in range(size):
        scale[i] = abs(a[i, i])
    for j in range(size):
        pivot, columns = a[j, j], packed.columns[packed.starts[j] : packed.starts[j + 1]]
        negative += pivot < 0.0
        sure = sure and abs(pivot) > _PIVOT * scale[j]
        last = columns[-1] + 1 if len(columns) else j
        for i in columns:
            factor = a[j, i] / pivot
            scale[i] += abs(factor * a[j, i])
            for c in range(uint(i), uint(last)):
                a[i, c] -= factor * a[j, c]
            for c in range(uint(size), uint(whole)):
                a[i, c] -= factor * a[j, c]
        scale[j] = -1.0 / pivot
    _products(a, scale, size, size, whole, whole, a)
    return negative, sure
