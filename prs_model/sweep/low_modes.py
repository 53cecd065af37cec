"""The lowest modes of many configurations, exactly, on all body coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError

from ..arrays import FloatArray
from ..linear_algebra import lowest_modes, slowest
from ..linear_algebra.unlocked import largest_of_pencil
from ..synthesis.batch import Systems

_MASSLESS = 1e-14  # of the largest mu: a direction without mass


@dataclass(frozen=True, eq=False)
class LowModes:
    """Eigenvalues (N, k) [rad^2/s^2] ascending and mass-normalised shapes (N, n, k); n counts all body coordinates."""

    eigenvalues: FloatArray
    shapes: FloatArray


def low_modes(systems: Systems, count: int, shift: float) -> LowModes:
    """The `count` lowest modes of each configuration (fewer where M has a lower rank in one of them).

    Solved as M x = mu (K - s M) x, so that directions without mass drop out; s is the shift given [rad^2/s^2], or where
    K - s M is not positive definite one of the configuration's own.
    Raises PrsError when a direction has neither mass nor stiffness, or K is indefinite.
    """
    pairs = [_lowest(*pencil, count, shift) for pencil in systems.pencils]
    fewest = min(len(values) for values, _ in pairs)
    return LowModes(
        np.array([values[:fewest] for values, _ in pairs]), np.array([shapes[:, :fewest] for _, shapes in pairs])
    )


def _lowest(
    mass: FloatArray, stiffness: FloatArray, free: FloatArray, count: int, shift: float
) -> tuple[FloatArray, FloatArray]:
    try:
        mu, shapes = slowest(mass, stiffness - shift * mass, count, largest_of_pencil)
        all_there = mu[-1] > _MASSLESS * mu[0]  # no massless direction, nor a mode so slow that others seem massless
    except LinAlgError:
        all_there = False
    if not all_there:
        values, shapes = lowest_modes(mass, stiffness, count)
        return values, free @ shapes
    return 1.0 / mu + shift, free @ (shapes / np.sqrt(mu))
