"""The lowest modes of many configurations, exactly, on all body coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError

from ..arrays import BoolArray, FloatArray
from ..linear_algebra import lowest_modes
from ..linear_algebra.unlocked import largest_of_pencil
from ..synthesis.batch import Systems
from ..synthesis.elimination import independent_coordinates

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
    pairs = [_lowest(*pencil, count, shift) for pencil in pencils(systems)]
    fewest = min(len(values) for values, _ in pairs)
    return LowModes(
        np.array([values[:fewest] for values, _ in pairs]), np.array([shapes[:, :fewest] for _, shapes in pairs])
    )


def pencils(systems: Systems) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """(M, K, T) of each configuration on its independent coordinates v, with u = T v; T has n rows."""
    used = np.any(systems.mass != 0.0, axis=(0, 1)) | np.any(systems.stiffness != 0.0, axis=(0, 1))
    if systems.constraints.shape[1]:
        return [
            _held(*each, used)
            for each in zip(systems.mass, systems.stiffness, systems.constraints, systems.constraint_sizes, strict=True)
        ]
    free = np.eye(len(used))[:, used]
    if used.all():
        return [(mass, stiffness, free) for mass, stiffness in zip(systems.mass, systems.stiffness, strict=True)]
    both = np.ix_(used, used)
    return [
        (mass[both], stiffness[both], free) for mass, stiffness in zip(systems.mass, systems.stiffness, strict=True)
    ]


def _held(
    mass: FloatArray, stiffness: FloatArray, rows: FloatArray, sizes: FloatArray, used: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    free, kept = independent_coordinates(rows, sizes)
    free = free[:, used[kept]]
    return free.T @ mass @ free, free.T @ stiffness @ free, free


def _lowest(
    mass: FloatArray, stiffness: FloatArray, free: FloatArray, count: int, shift: float
) -> tuple[FloatArray, FloatArray]:
    try:
        mu, shapes = _largest(mass, stiffness - shift * mass, count)
    except LinAlgError:
        values, shapes = lowest_modes(mass, stiffness, count)
        return values, free @ shapes
    present = mu > _MASSLESS * mu[0]
    if present.sum() < min(count, len(mass)):  # massless directions, or a mode so slow that all others seem so
        values, shapes = lowest_modes(mass, stiffness, count)
        return values, free @ shapes
    return 1.0 / mu[present] + shift, free @ (shapes / np.sqrt(mu))[:, present]


def _largest(mass: FloatArray, pencil: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    diagonal = np.diag(pencil)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaling = np.outer(scale, scale)
    mu, vectors = largest_of_pencil(mass * scaling, pencil * scaling, count)
    return mu, vectors * scale[:, None]
