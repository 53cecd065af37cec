"""Frequencies of a part by itself: with no node held, and with all of them held."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh, null_space

from ..arrays import FloatArray
from ..linear_algebra import lowest_modes, slowest_rate
from .super_element import SuperElement

RANK = 1e-10
UNMET = 1e-12  # of the stiffness and inertia that motions meet: round-off
LOOSE = 1e-14  # of the largest K_ii / M_ii: the eigenvalue of a motion without stiffness


def free_frequencies(element: SuperElement, count: int) -> FloatArray:
    """The lowest frequencies (k,) [Hz], k <= count, with no node held; of a grounded part as it is held.

    Rigid motion has none, nor have inner motions that meet no stiffness. Raises PrsError for an indefinite stiffness.
    """
    if element.grounded:
        return _frequencies(element, np.eye(element.size), count)
    found = _frequencies(element, _elastic(element), count + 6)
    return np.asarray(found[found > np.sqrt(LOOSE * _fastest_rate(element)) / (2.0 * np.pi)][:count])


def held_frequencies(element: SuperElement, count: int) -> FloatArray:
    """The lowest frequencies (k,) [Hz], k <= count, with the motions of all nodes held. Raises as free_frequencies."""
    return _frequencies(element, _inner(element), count)


def _inner(element: SuperElement) -> FloatArray:
    """A basis (n, p) of the coordinates that leave every node where it is."""
    motions = element.motions.reshape(-1, element.size)
    size = np.linalg.norm(motions)
    return np.asarray(null_space(motions / size, rcond=RANK)) if size > 0.0 else np.eye(element.size)


def _elastic(element: SuperElement) -> FloatArray:
    """A basis (n, p) of the motions that carry no momentum: all but the rigid ones."""
    momentum = element.mass @ element.rigid_body_modes()
    size = np.linalg.norm(momentum, axis=0)
    momentum = momentum[:, size > 0.0] / size[size > 0.0]
    return np.asarray(null_space(momentum.T, rcond=RANK)) if momentum.size else np.eye(element.size)


def _frequencies(element: SuperElement, basis: FloatArray, count: int) -> FloatArray:
    mass, stiffness = (_symmetric(basis.T @ matrix @ basis) for matrix in (element.mass, element.stiffness))
    met = _met(mass, stiffness)
    if met is not None:
        mass, stiffness = (_symmetric(met.T @ matrix @ met) for matrix in (mass, stiffness))
    if not np.any(mass):
        return np.zeros(0)
    values = lowest_modes(mass, stiffness, count)[0]
    return np.asarray(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi))


def _met(mass: FloatArray, stiffness: FloatArray) -> FloatArray | None:
    """A basis (n, p) of the motions that meet stiffness or inertia; None when all do.

    The turning of a point mass meets neither.
    """
    pencil = stiffness + slowest_rate(mass, stiffness) * mass
    size = np.sqrt(np.abs(np.diag(pencil)))
    scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
    values, vectors = eigh(pencil * np.outer(scale, scale)) if size.size else (size, pencil)
    there = np.abs(values) > UNMET * len(values)
    return None if there.all() else np.asarray(scale[:, None] * vectors[:, there])


def _fastest_rate(element: SuperElement) -> float:
    """The largest K_ii / M_ii [rad^2/s^2]."""
    mass, stiffness = np.diag(element.mass), np.diag(element.stiffness)
    return float(np.max(stiffness[mass > 0.0] / mass[mass > 0.0], initial=0.0))


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray((matrix + matrix.T) / 2.0)
