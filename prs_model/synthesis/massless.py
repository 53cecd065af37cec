"""Motions of a body that neither strain it nor have momentum: nothing but joints can hold them."""

from __future__ import annotations

import numpy as np
from scipy.linalg import qr

from ..arrays import FloatArray, IntArray

_SINGULAR = 1e-12  # of a matrix with a unit diagonal
_CLEARLY_NOT = 1e-4  # a pivot of its Cholesky factor, above which nothing is looked for


def massless_motions(mass: FloatArray, stiffness: FloatArray, some: IntArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Splits coordinates `some` (n,) of M and K (N or 1, .., ..), none of whose rows are zero in both, by the null
    space of M and K that is the same in all configurations.

    Returns those that are left (n - e,), those that lead the null space (e,), and W (n - e, e): a motion u of the
    latter, and W u of the former, is in it. M and K of those that are left have no common null space.
    """
    masses, stiffnesses = (each[:, some[:, None], some] for each in (mass, stiffness))
    whole = masses / _largest(masses) + stiffnesses / _largest(stiffnesses)
    scale = 1.0 / np.sqrt(np.diagonal(whole, axis1=1, axis2=2)[0])
    whole = whole * scale[:, None] * scale
    null = _null_space(whole[0])
    if not null.shape[1] or np.abs(whole @ null).max() > np.sqrt(_SINGULAR):
        return some, some[:0], np.zeros((len(some), 0))
    order = qr(null.T, mode="r", pivoting=True)[1]
    led, left = np.sort(order[: null.shape[1]]), np.sort(order[null.shape[1] :])
    motions = scale[:, None] * null
    return some[left], some[led], np.linalg.solve(motions[led].T, motions[left].T).T


def _null_space(matrix: FloatArray) -> FloatArray:
    """(n, e) of a semi-definite matrix with a unit diagonal."""
    try:
        if np.diag(np.linalg.cholesky(matrix)).min(initial=1.0) > _CLEARLY_NOT:
            return matrix[:, :0]
    except np.linalg.LinAlgError:  # it has a null space, but for rounding
        pass
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors[:, values < _SINGULAR])


def _largest(matrices: FloatArray) -> float:
    return float(np.abs(matrices).max(initial=0.0)) or 1.0
