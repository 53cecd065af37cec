"""Newton's method on many poses at once."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ..arrays import BoolArray, FloatArray
from .equations import Equations

TOLERANCE = 1e-12
"""Largest residual [m, rad] of a solved pose."""

_LONGEST_STEP = 0.5


def newton(
    equations: Equations, start: FloatArray, targets: FloatArray, iterations: int = 12
) -> tuple[FloatArray, BoolArray]:
    """Joint values (N, n) from `start` (N, n), and which of them solve the equations to `TOLERANCE` (N,).

    Steps are least-squares solutions, so that redundant rows (a planar loop closed by six equations) do no harm, and
    no joint moves by more than half a radian or metre in one. A pose for which there is no step stays unsolved.
    """
    q, solved = start.copy(), np.zeros(len(start), dtype=bool)
    open_rows = np.arange(len(start))
    for _ in range(iterations + 1):
        frames = equations.tree.forward(q[open_rows])
        residual = equations.residual(frames, targets[open_rows])
        done = np.max(np.abs(residual), axis=1, initial=0.0) <= TOLERANCE
        solved[open_rows[done]] = True
        if done.all():
            break
        if done.any():
            open_rows, residual = open_rows[~done], residual[~done]
            frames = type(frames)(frames.rotations[~done], frames.positions[~done])
        step = _least_squares(equations.jacobian(frames, targets[open_rows]), residual)
        step[~np.isfinite(step).all(axis=1)] = 0.0
        longest = np.max(np.abs(step), axis=1, keepdims=True)
        q[open_rows] -= step * np.minimum(1.0, _LONGEST_STEP / np.maximum(longest, _LONGEST_STEP))
    return q, solved


def _least_squares(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """The steps (N, n) that minimise |jacobian step - residual|."""
    try:
        if jacobian.shape[1] == jacobian.shape[2]:
            return np.asarray(np.linalg.solve(jacobian, residual[..., None])[..., 0])
        Q, R = np.linalg.qr(jacobian)
        return np.asarray(np.linalg.solve(R, np.swapaxes(Q, -1, -2) @ residual[..., None])[..., 0])
    except np.linalg.LinAlgError:  # one of the poses is singular to the last digit
        return np.array([least_squares_of_one(*pose) for pose in zip(jacobian, residual, strict=True)])


def least_squares_of_one(jacobian: FloatArray, residual: FloatArray, tolerance: float | None = None) -> FloatArray:
    """The smallest step (n,) that minimises |jacobian step - residual| for one pose; zero where there is none.

    Singular values below `tolerance` times the largest count as zero (default: rounding).
    """
    if np.isfinite(jacobian).all() and np.isfinite(residual).all():
        with suppress(np.linalg.LinAlgError):
            return np.asarray(np.linalg.lstsq(jacobian, residual, rcond=tolerance)[0])
    return np.zeros(jacobian.shape[1])
