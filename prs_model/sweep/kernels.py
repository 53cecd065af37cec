"""Small symmetric matrices by the hundred thousand, in plain NumPy: no checks, pose axis last.

A batch of p x p matrices is packed as (p (p + 1) / 2, m): the lower triangles row by row, poses innermost.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def unpacked(packed: FloatArray, p: int) -> FloatArray:
    """(m, p, p) full matrices."""
    full = np.empty((p, p, packed.shape[1]))
    rows, columns = np.tril_indices(p)
    full[rows, columns] = packed
    full[columns, rows] = packed
    return np.ascontiguousarray(np.moveaxis(full, 2, 0))


def eigenvalues(packed: FloatArray, p: int) -> FloatArray:
    """(p, m) ascending."""
    return np.ascontiguousarray(np.linalg.eigvalsh(unpacked(packed, p)).T)


def negatives(packed: FloatArray, p: int, slack: float) -> IntArray:
    """Number of eigenvalues below -slack (m,)."""
    return np.asarray((np.linalg.eigvalsh(unpacked(packed, p)) < -slack).sum(axis=1))


def as_frobenius(packed: FloatArray) -> FloatArray:
    """Packed triangles (.., p (p + 1) / 2), here last, whose norm is the Frobenius norm of the symmetric matrices."""
    p = int((np.sqrt(8.0 * packed.shape[-1] + 1.0) - 1.0) / 2.0 + 0.5)
    rows, columns = np.tril_indices(p)
    return packed * np.where(rows == columns, 1.0, np.sqrt(2.0))
