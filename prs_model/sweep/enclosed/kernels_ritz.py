"""A dual system on a few shapes, and its eigenvalues counted, at many poses: plain NumPy, no checks, pose axis first.

With X^T (K_0 - s M) X = diag(d) of each body, and the wrenches B and the momenta M V on it side by side,

    [[H, g], [g^T, G_0]] = Y^T diag(1 / d) Y,    Y = X^T [B^T, M V],

is what it adds to [[S, g], [g^T, G_0]]. Eliminating S leaves A = G_0 - g^T S^-1 g. Negative d of all bodies, less the
negative eigenvalues of S, is the number of eigenvalues below s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_SINGULAR = 1e-10  # an eigenvalue of a matrix with unit rows


class Packed(NamedTuple):
    """A dual system at N poses, at a shift s, with shapes V of r columns; body after body in flat arrays.

    sizes (b, 3): of each body the numbers of wrenches k and of coordinates n, and whether its matrices follow the pose.
    rows (sum of k): of S, of its wrenches, ascending. readings (N, sum of n k): B^T. Of bodies that are the same at all
    poses roots (sum of n^2): X^T; pivots (sum of n): d; inertias (sum of n): X^T M X, which is diagonal; loads (sum of
    n r): X^T M V. Of those that follow the pose pencils, masses (N, sum of n^2): K_0 - s M and M; shapes (sum of n r):
    V. entries (m, 2) and values (N, m): places in the upper triangle of S, and what is added there. starts (q + 1,):
    row j of S has entries, when its turn to be eliminated comes, in columns[starts[j]:starts[j + 1]] beside its
    diagonal. constant (q + r, q + r) and mass (r, r): upper triangles of what is the same at all poses of
    [[S, g], [g^T, G_0]] and of V^T M V; below: how many eigenvalues it adds below s.
    """

    sizes: IntArray
    rows: IntArray
    readings: FloatArray
    roots: FloatArray
    pivots: FloatArray
    inertias: FloatArray
    loads: FloatArray
    pencils: FloatArray
    masses: FloatArray
    shapes: FloatArray
    entries: IntArray
    values: FloatArray
    starts: IntArray
    columns: IntArray
    constant: FloatArray
    mass: FloatArray
    below: int


class _Body(NamedTuple):
    """Rows of S (k,), X^T B^T (N, n, k), X^T M V (N, n, r), d (N or 1, n), X^T M X (N or 1, n, n)."""

    rows: IntArray
    forces: FloatArray
    loads: FloatArray
    pivots: FloatArray
    inertia: FloatArray


def below(packed: Packed) -> tuple[IntArray, BoolArray]:
    """How many eigenvalues lie below the shift (N,), and whether that is sure (N,)."""
    bodies, whole, _ = _assembled(packed)
    size = len(packed.constant) - len(packed.mass)
    S = whole[:, :size, :size]
    scale = _to_unit_rows(S)
    values = np.linalg.eigvalsh(S * scale[:, :, None] * scale[:, None])
    count, sure = packed.below - (values < 0.0).sum(axis=1), (np.abs(values) > _SINGULAR).all(axis=1)
    for each in bodies:
        if len(each.inertia) > 1:
            count += (each.pivots < 0.0).sum(axis=1)
            sure &= (np.abs(each.pivots) > _SINGULAR).all(axis=1)
    return count, sure


def moments(packed: Packed, count: int) -> FloatArray:
    """(N, 3, count, count): X^T M T^k X with k = 2, 3, 4 and T = (K - s M)^-1 M, of the Ritz vectors X of T on V with
    the largest Ritz values mu, as columns of X diag(1 / mu)."""
    bodies, whole, mass = _assembled(packed)
    size = len(packed.constant) - len(packed.mass)
    S, g = whole[:, :size, :size], whole[:, :size, size:]
    root = np.linalg.inv(np.linalg.cholesky(mass))
    matrices = root @ (whole[:, size:, size:] - _transposed(g) @ np.linalg.solve(S, g)) @ _transposed(root)
    values, vectors = np.linalg.eigh(matrices)
    some = slice(None, -count - 1, -1)
    chosen = _transposed(root) @ (vectors[:, :, some] / values[:, None, some])
    once = _applied(bodies, S, [each.loads @ chosen for each in bodies])
    loads = [each.inertia @ shapes for each, shapes in zip(bodies, once, strict=True)]
    twice = _applied(bodies, S, loads)
    further = [each.inertia @ shapes for each, shapes in zip(bodies, twice, strict=True)]
    pairs = ((once, loads), (twice, loads), (twice, further))
    return np.stack([sum(_transposed(a) @ b for a, b in zip(*pair, strict=True)) for pair in pairs], axis=1)


def _assembled(packed: Packed) -> tuple[list[_Body], FloatArray, FloatArray]:
    """The bodies; [[S, g], [g^T, G_0]] (N, q + r, q + r); V^T M V (N, r, r)."""
    count, r = len(packed.readings), len(packed.mass)
    whole, mass = (
        np.repeat((each + np.triu(each, 1).T)[None], count, axis=0) for each in (packed.constant, packed.mass)
    )
    i, j = packed.entries.T
    whole[:, i, j] += packed.values
    whole[:, j, i] += np.where(i == j, 0.0, packed.values)
    bodies = []
    rows = readings = fixed = moving = diagonals = loads = shapes = 0
    for k, n, follows in packed.sizes.tolist():
        where = packed.rows[rows : (rows := rows + k)]
        forces = packed.readings[:, readings : (readings := readings + n * k)].reshape(count, n, k)
        if follows:
            some = slice(moving, moving := moving + n * n)
            pencil, own = (each[:, some].reshape(count, n, n) for each in (packed.pencils, packed.masses))
            shape = packed.shapes[shapes : (shapes := shapes + n * r)].reshape(n, r)
            scale = _to_unit_rows(pencil)
            pivots, turn = np.linalg.eigh(pencil * scale[:, :, None] * scale[:, None])
            turn *= scale[:, :, None]
            back = _transposed(turn)
            body = _Body(where, back @ forces, back @ (own @ shape), pivots, back @ own @ turn)
            mass += shape.T @ own @ shape
        else:
            some = slice(diagonals, diagonals := diagonals + n)
            root = packed.roots[fixed : (fixed := fixed + n * n)].reshape(n, n)
            load = packed.loads[loads : (loads := loads + n * r)].reshape(1, n, r)
            inertia = np.diag(packed.inertias[some])[None]
            body = _Body(where, root @ forces, np.repeat(load, count, axis=0), packed.pivots[None, some], inertia)
        bodies.append(body)
        beside = np.concatenate([body.forces, body.loads], axis=2)
        added = _transposed(beside) @ (beside / body.pivots[:, :, None])
        if not follows:
            added[:, k:, k:] = 0.0  # it is in `constant`
        places = np.concatenate([where, np.arange(len(packed.constant) - r, len(packed.constant))])
        whole[:, places[:, None], places] += added
    return bodies, whole, mass


def _to_unit_rows(matrices: FloatArray) -> FloatArray:
    """Factors (N, q) of rows, and of columns alike, of symmetric matrices, for their largest entries to be near 1."""
    sizes, scale = np.abs(matrices), np.ones(matrices.shape[:2])
    for _ in range(3):
        largest = (sizes * scale[:, :, None] * scale[:, None]).max(axis=2, initial=0.0)
        scale /= np.sqrt(np.where(largest > 0.0, largest, 1.0))
    return scale


def _applied(bodies: list[_Body], S: FloatArray, loads: list[FloatArray]) -> list[FloatArray]:
    """(K - s M)^-1 of loads (N, n, p), of each body and on its coordinates X."""
    wrenches = np.zeros((*S.shape[:2], loads[0].shape[2]))
    for body, load in zip(bodies, loads, strict=True):
        wrenches[:, body.rows] += _transposed(body.forces) @ (load / body.pivots[:, :, None])
    wrenches = np.linalg.solve(S, wrenches)
    return [
        (load - body.forces @ wrenches[:, body.rows]) / body.pivots[:, :, None]
        for body, load in zip(bodies, loads, strict=True)
    ]


def _transposed(matrix: FloatArray) -> FloatArray:
    return np.swapaxes(matrix, -1, -2)
