"""How far frequencies found in the dual form are off by rounding: a first-order estimate, not a proof.

With x^T M x = 1 and joint wrenches phi in a mode, matrices with unit e put its eigenvalue off by

    n e (phi^T diag(S) phi + (lambda - s)^2 / |s| (1 + x^T diag(K_0) x / |s| + x^T diag(M) x)):

S where light parts, or levers, make its rows nearly depend on each other; and what G adds to the free bodies before
the joints take most of it away again (as in Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., 10.1).
"""

from __future__ import annotations

import numpy as np

from ...arrays import FloatArray
from ...synthesis.dual import DualSystems


def dual_rounding(dual: DualSystems, eigenvalues: FloatArray, shapes: FloatArray, shift: float) -> FloatArray:
    """Relative, of the frequencies (N, p) of modes with eigenvalues (N, p) and shapes (N, n, p), at a shift s < 0.

    Infinite for eigenvalues that are not positive. Raises numpy.linalg.LinAlgError where S is singular.
    """
    S, _ = dual.at(shift)
    loads, along = np.zeros((*S.shape[:2], shapes.shape[2])), np.ones_like(eigenvalues)
    start = 0
    for name, element in dual.elements.items():
        own, (rows, reading) = dual.coordinates[name].own, dual.bodies[name]
        shape = shapes[:, start : (start := start + element.size)]
        diagonals = np.diagonal(element.mass + element.stiffness / -shift, axis1=1, axis2=2)
        along += np.sum(diagonals[:, :, None] * shape**2, axis=1)
        root, pivots = dual.decoupled(name, shift)
        moved = (reading[..., own] @ root) / pivots[:, None]
        loads[:, rows] += moved @ (root.swapaxes(1, 2) @ (element.mass @ shape)[:, own])
    wrenches = np.linalg.solve(S, loads)  # over lambda - s
    felt = np.sum(np.diagonal(S, axis1=1, axis2=2)[:, :, None] * wrenches**2, axis=1)
    off = shapes.shape[1] * np.finfo(float).eps * (eigenvalues - shift) ** 2 * (felt + along / -shift)
    positive = eigenvalues > 0.0
    return np.where(positive, 0.5 * off / np.where(positive, eigenvalues, 1.0), np.inf)
