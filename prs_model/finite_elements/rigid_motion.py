"""Rigid motion of points: how one motion (delta, epsilon) shows up elsewhere on the same rigid body."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray


def cross_matrix(r: ArrayLike) -> FloatArray:
    """[r]x with [r]x v = r x v; shape (..., 3) to (..., 3, 3)."""
    r = np.asarray(r, dtype=float)
    matrix = np.zeros((*r.shape, 3))
    matrix[..., 2, 1], matrix[..., 0, 2], matrix[..., 1, 0] = r[..., 0], r[..., 1], r[..., 2]
    matrix[..., 1, 2], matrix[..., 2, 0], matrix[..., 0, 1] = -r[..., 0], -r[..., 1], -r[..., 2]
    return matrix


def transfer(r: ArrayLike) -> FloatArray:
    """X(r) = [[1, -[r]x], [0, 1]]: the motion of a point from that of another, r [m] from the other to the point.

    Shape (..., 3) to (..., 6, 6). X(a) X(b) = X(a + b); the paper's eq. (4) with r reversed.
    """
    r = np.asarray(r, dtype=float)
    matrix = np.zeros((*r.shape[:-1], 6, 6))
    matrix[..., :, :] = np.eye(6)
    matrix[..., :3, 3:] = -cross_matrix(r)
    return matrix
