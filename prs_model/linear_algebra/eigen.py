"""The generalised symmetric eigenproblem K x = lambda M x for the lowest modes, M singular or not."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh

from ..arrays import FloatArray
from ..errors import PrsError

Largest = Callable[[FloatArray, FloatArray, int], tuple[FloatArray, FloatArray]]
"""Solves a x = mu b x for the largest mu, descending, and vectors of unit x^T b x."""

_PIVOT_TOLERANCE = 1e-12
_MASS_TOLERANCE = 1e-14
_LOOSE = 1e6  # of the slowest rate of a held coordinate over an eigenvalue: beside a mode so slow others lose digits
_BELOW = -1e-3  # of that rate: the shift of what is free, or nearly so
_INDEFINITE = 1e-9


def lowest_modes(
    mass: FloatArray, stiffness: FloatArray, count: int, labels: Sequence[object] | None = None
) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues (k,) [rad^2/s^2] ascending and mass-normalised shapes (n, k), k = min(count, rank of M).

    Solved as M x = mu (K - s M) x with mu = 1 / (lambda - s), so that directions without mass are modes of
    infinite frequency and drop out. The shift s is zero where K is positive definite, and below zero for a
    free or partly free structure. Each shape's largest entry is positive.
    Raises PrsError when a direction has neither mass nor stiffness, or K is indefinite; `labels` name the coordinates.
    """
    shift, pencil = positive_definite_pencil(mass, stiffness, labels)
    mu, shapes = slowest(mass, pencil, count)
    rate = slowest_rate(mass, stiffness)
    if shift == 0.0 and mu[0] * rate > _LOOSE:
        shift = _BELOW * rate
        mu, shapes = slowest(mass, stiffness - shift * mass, count)
    heavy = mu > _MASS_TOLERANCE * mu[0]
    mu, shapes = mu[heavy], shapes[:, heavy]
    shapes = shapes / np.sqrt(mu)
    signs = np.sign(shapes[np.argmax(np.abs(shapes), axis=0), np.arange(shapes.shape[1])])
    return 1.0 / mu + shift, shapes * signs


def _largest(a: FloatArray, b: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """The `count` largest eigenvalues of a x = mu b x with their vectors, the largest first."""
    n = len(a)
    try:
        mu, vectors = eigh(a, b, subset_by_index=[max(n - count, 0), n - 1])
    except LinAlgError:  # bisection may fail on clusters of eigenvalues, where solving for all of them does not
        mu, vectors = eigh(a, b, driver="gvd")
    return mu[::-1][:count], vectors[:, ::-1][:, :count]


def slowest(
    mass: FloatArray, pencil: FloatArray, count: int, largest: Largest = _largest
) -> tuple[FloatArray, FloatArray]:
    """The `count` largest mu of M x = mu (K - s M) x, descending, and shapes (n, count) of unit x^T (K - s M) x.

    largest: solves the pencil scaled to a unit diagonal. Raises as it does where K - s M is not positive definite.
    """
    diagonal = np.diag(pencil)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaling = np.outer(scale, scale)
    mu, vectors = largest(mass * scaling, pencil * scaling, count)
    return mu, vectors * scale[:, None]


def slowest_rate(mass: FloatArray, stiffness: FloatArray) -> float:
    """The smallest K_ii / M_ii [rad^2/s^2] of a coordinate that is held: a scale above the first elastic eigenvalue."""
    m, k = np.diag(mass), np.diag(stiffness)
    rates = k[m > 0] / m[m > 0]
    held = rates[rates > 1e-12 * rates.max(initial=0.0)]
    return float(held.min()) if held.size else 1.0


def positive_definite_pencil(
    mass: FloatArray, stiffness: FloatArray, labels: Sequence[object] | None = None
) -> tuple[float, FloatArray]:
    """The shift s [rad^2/s^2] and the positive definite K - s M; s is 0 for a structure that is held, else below it.

    Raises PrsError when a direction has neither mass nor stiffness, or K is indefinite; `labels` name the coordinates.
    """
    if _is_positive_definite(stiffness):
        return 0.0, stiffness
    shift = _BELOW * slowest_rate(mass, stiffness)
    shifted = stiffness - shift * mass
    if _is_positive_definite(shifted):
        return shift, shifted
    raise PrsError(_what_is_wrong(mass, stiffness, labels))


def _is_positive_definite(matrix: FloatArray) -> bool:
    if not np.all(np.diag(matrix) > 0):
        return False
    try:
        factor = cholesky(_unit_diagonal(matrix), lower=True)
    except LinAlgError:
        return False
    return bool(np.min(np.diag(factor)) ** 2 > _PIVOT_TOLERANCE * len(matrix))


def _unit_diagonal(matrix: FloatArray) -> FloatArray:
    diagonal = np.abs(np.diag(matrix))
    scale = 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return np.asarray(matrix * np.outer(scale, scale))


def _what_is_wrong(mass: FloatArray, stiffness: FloatArray, labels: Sequence[object] | None) -> str:
    values, vectors = eigh(_unit_diagonal(stiffness), subset_by_index=[0, 0])
    if values[0] < -_INDEFINITE:
        return (
            f"the stiffness of the system is indefinite (scaled eigenvalue {values[0]:.3g}); "
            "check the parts' matrices with their physics gate, and joint stiffness matrices for wrong signs"
        )
    vectors = eigh(_unit_diagonal(stiffness + slowest_rate(mass, stiffness) * mass), subset_by_index=[0, 0])[1]
    worst = int(np.argmax(np.abs(vectors[:, 0])))
    where = f" at {labels[worst]}" if labels is not None else f" at coordinate {worst}"
    return (
        f"the system is singular{where}: a motion meets neither stiffness nor mass; "
        "check for a joint that frees the same rotation twice, or a node that nothing holds"
    )
