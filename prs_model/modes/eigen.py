"""The generalised symmetric eigenproblem K x = lambda M x for the lowest modes, M singular or not."""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh

from ..arrays import FloatArray
from ..errors import PrsError

_PIVOT_TOLERANCE = 1e-12
_MASS_TOLERANCE = 1e-14


def lowest_modes(mass: FloatArray, stiffness: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues (k,) [rad^2/s^2] ascending and mass-normalised shapes (n, k), k = min(count, rank of M).

    Solved as M x = mu (K - s M) x with mu = 1 / (lambda - s), so that directions without mass are modes of
    infinite frequency and drop out. The shift s is zero where K is positive definite, and below zero for a
    free or partly free structure. Each shape's largest entry is positive.
    Raises PrsError when a direction has neither mass nor stiffness.
    """
    shift, pencil = _positive_definite(mass, stiffness)
    scale = 1.0 / np.sqrt(np.diag(pencil))
    scaling = np.outer(scale, scale)
    n = len(scale)
    first = max(n - count, 0)
    mu, vectors = eigh(mass * scaling, pencil * scaling, subset_by_index=[first, n - 1])
    mu, vectors = mu[::-1], vectors[:, ::-1]
    heavy = mu > _MASS_TOLERANCE * mu[0]
    mu, shapes = mu[heavy], (vectors * scale[:, None])[:, heavy]
    shapes = shapes / np.sqrt(mu)
    signs = np.sign(shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])])
    return 1.0 / mu + shift, shapes * signs


def _positive_definite(mass: FloatArray, stiffness: FloatArray) -> tuple[float, FloatArray]:
    """The shift s and the positive definite K - s M."""
    if _is_positive_definite(stiffness):
        return 0.0, stiffness
    heavy = np.diag(mass) > 0
    if heavy.any():
        shift = -1e-3 * float(np.min(np.diag(stiffness)[heavy] / np.diag(mass)[heavy]))
        shifted = stiffness - shift * mass
        if shift < 0 and _is_positive_definite(shifted):
            return shift, shifted
    raise PrsError(
        "the system is singular: a coordinate can move with neither stiffness nor mass against it; "
        "check for a joint that frees the same rotation twice, or a node that nothing holds"
    )


def _is_positive_definite(matrix: FloatArray) -> bool:
    diagonal = np.diag(matrix)
    if not np.all(diagonal > 0):
        return False
    scale = 1.0 / np.sqrt(diagonal)
    try:
        factor = cholesky(matrix * np.outer(scale, scale), lower=True)
    except LinAlgError:
        return False
    return bool(np.min(np.diag(factor)) ** 2 > _PIVOT_TOLERANCE * len(matrix))
