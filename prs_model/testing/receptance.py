"""Two elements are the same part when every interface answers every force alike, whatever their coordinates are."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..reduction import SuperElement
from ..reduction.summary import summarize

ALIKE = 1e-8
SHIFTS = (1.0, 100.0)  # of the first elastic eigenvalue


def first_eigenvalue(element: SuperElement) -> float:
    """The lowest elastic one [rad^2/s^2]; 1 of a rigid body."""
    free = summarize(element, 1).free
    return float((2.0 * np.pi * free[0]) ** 2) if free.size and free[0] > 0.0 else 1.0


def receptances(element: SuperElement, eigenvalue: float) -> FloatArray:
    """(2, 6k, 6k) [m/N, rad/N ..]: H(s) = Phi (K + s^2 M)^-1 Phi^T at two real s, Phi the motions of the k nodes.

    Nodes are in the order of their names. Unlike mode shapes these have no sign and no order to choose.
    """
    order = np.argsort(element.nodes)
    motions = element.motions[order].reshape(-1, element.size)
    answers = []
    for shift in SHIFTS:
        matrix = element.stiffness + shift * eigenvalue * element.mass
        size = np.sqrt(np.maximum(np.diag(matrix), 0.0))
        scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
        inverse = np.linalg.pinv(matrix * np.outer(scale, scale), rcond=1e-13, hermitian=True)
        answers.append((motions * scale) @ inverse @ (motions * scale).T)
    return np.array(answers)


def difference(found: FloatArray, expected: FloatArray) -> float:
    """The largest difference, relative to the receptances of both motions by themselves; infinite for other nodes."""
    if found.shape != expected.shape:
        return float("inf")
    own = np.sqrt(np.abs(np.diagonal(expected, axis1=1, axis2=2)))
    scale = own[:, :, None] * own[:, None, :]
    apart = np.abs(found - expected)
    return float(np.max(np.divide(apart, scale, out=apart, where=scale > 0.0), initial=0.0))


class Whole:
    """A part that others are compared with, which should be the same."""

    def __init__(self, element: SuperElement):
        self.kind = _kind(element)
        self.positions = _positions(element)
        self.eigenvalue = first_eigenvalue(element)
        self.receptances = receptances(element, self.eigenvalue)

    def difference(self, element: SuperElement) -> float:
        """Of places, relative to the part's size, and receptances; infinite for other nodes, modes or ground."""
        if _kind(element) != self.kind:
            return float("inf")
        size = float(np.ptp(self.positions, axis=0).max(initial=0.0)) or 1.0
        moved = float(np.max(np.abs(_positions(element) - self.positions), initial=0.0)) / size
        return max(moved, difference(receptances(element, self.eigenvalue), self.receptances))


def _kind(element: SuperElement) -> tuple[list[str], int, bool]:
    return sorted(element.nodes), element.n_modes, element.grounded


def _positions(element: SuperElement) -> FloatArray:
    return element.positions[np.argsort(element.nodes)]
