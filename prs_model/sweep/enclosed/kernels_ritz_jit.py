"""The same as `kernels_ritz`, compiled by numba: pose by pose, all that belongs to one stays in the cache.

Pivots are not chosen. Below all eigenvalues none is small; elsewhere one that is, beside what it is the difference of,
makes the count doubtful.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from .small_jit import PIVOT, copy, eliminated, fill, largest, products, ritz_vectors, uint

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_WIDTH = 8  # columns that are improved at a time


def below(packed: Any) -> tuple[IntArray, BoolArray]:
    """How many eigenvalues lie below the shift (N,), and whether that is sure (N,)."""
    _, number, sure = _worked_out(packed, 0)
    return number, sure


def moments(packed: Any, count: int) -> FloatArray:
    """(N, 3, count, count): X^T M T^k X with k = 2, 3, 4 and T = (K - s M)^-1 M, of the Ritz vectors X of T on V with
    the largest Ritz values mu, as columns of X diag(1 / mu)."""
    result, _, _ = _worked_out(packed, count)
    return np.asarray(result)


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _worked_out(packed: Any, count: int) -> tuple[FloatArray, IntArray, BoolArray]:
    """Both: one kernel is compiled in less time than two."""
    r, whole = len(packed.mass), len(packed.constant)
    size, many, most = whole - r, len(packed.sizes), largest(packed.sizes, 1)
    result = np.empty((len(packed.readings), 3, count, count))
    number, sure = np.empty(len(result), dtype=np.int64), np.empty(len(result), dtype=np.bool_)
    x, pencils = np.empty((many, most, largest(packed.sizes, 0) + r)), np.empty((many, most, most))
    a, mass, d, scale = np.empty((whole, whole)), np.empty((r, r)), np.empty((many, most)), np.empty(whole + most)
    blocks, wrenches = -(-count // _WIDTH), np.empty((size, _WIDTH))
    shape = (blocks, many, most, _WIDTH)
    loads, once, further, twice = np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for p in range(len(result)):
        negative, certain = _assembled(packed, p, a, mass, x, pencils, d, scale)
        ours, fine = _condensed(packed, a, scale)
        number[p], sure[p] = negative - ours, certain and fine
        if count == 0:
            continue
        chosen = ritz_vectors(a[size:, size:], mass, count)
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
    return result, number, sure


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _loads(packed: Any, x: FloatArray, chosen: FloatArray, first: int, result: FloatArray) -> None:
    """X^T M V of each body times columns first, .. of those chosen (r, p); zero beyond them."""
    wide = min(_WIDTH, chosen.shape[1] - first)
    for b in range(len(packed.sizes)):
        k, n, _ = packed.sizes[b]
        fill(result[b], n, _WIDTH)
        for i in range(n):
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
    fill(wrenches, size, _WIDTH)
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
        copy(loads[b, :n], result[b])
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
        own, physical = packed.masses[p, moving : moving + n * n].reshape(n, n), np.empty((n, _WIDTH))
        copy(shapes[b, :n], physical)
        moving += n * n
        for j in range(n - 1, -1, -1):
            for i in range(j + 1, n):
                factor = pencils[b, j, i] / d[b, j]
                for c in range(wide):
                    physical[j, c] -= factor * physical[i, c]
        fill(result[b], n, _WIDTH)
        for i in range(n):
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
    copy(packed.constant, a)
    copy(packed.mass, mass)
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
            copy(packed.pencils[p, moving : moving + n * n].reshape(n, n), pencils[b])
            shape = packed.shapes[shapes : shapes + n * len(mass)].reshape(n, len(mass))
            _beside(own, shape, forces, x[b], mass)
            negative, certain = eliminated(pencils[b], x[b], n, width, scale)
            number, fine = number + negative, fine and certain
            for i in range(n):
                d[b, i] = pencils[b, i, i]
            moving += n * n
            shapes += n * len(mass)
        else:
            root = packed.roots[fixed : fixed + n * n].reshape(n, n)
            load = packed.loads[loads : loads + n * len(mass)].reshape(n, len(mass))
            _turned(root, forces, load, x[b])
            for i in range(n):
                d[b, i] = packed.pivots[diagonals + i]
            fixed += n * n
            loads += n * len(mass)
            diagonals += n
        last = width if follows else k
        fill(added, last, width)
        for i in range(n):
            scale[i] = 1.0 / d[b, i]
        products(x[b], scale, n, 0, last, width, added)
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
        for c in range(k):
            x[i, c] = forces[i, c]
        for c in range(k, k + r):
            x[i, c] = 0.0
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
        for c in range(k):
            x[i, c] = 0.0
        for c in range(r):
            x[i, k + c] = load[i, c]
        for j in range(n):
            factor = root[i, j]
            for c in range(uint(0), uint(k)):
                x[i, c] += factor * forces[j, c]


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
        sure = sure and abs(pivot) > PIVOT * scale[j]
        last = columns[-1] + 1 if len(columns) else j
        for i in columns:
            factor = a[j, i] / pivot
            scale[i] += abs(factor * a[j, i])
            for c in range(uint(i), uint(last)):
                a[i, c] -= factor * a[j, c]
            for c in range(uint(size), uint(whole)):
                a[i, c] -= factor * a[j, c]
        scale[j] = -1.0 / pivot
    products(a, scale, size, size, whole, whole, a)
    return negative, sure
