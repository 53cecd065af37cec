"""Whether eigenvalues below the level are missed, tested on the whole system at single poses.

Interpolation sees what shows at nodes. A mode that is apart from all followed ones may come down between them unseen.
At a given pose that cannot be when

    K - l M + b M V V^T M,   b > 0,

is positive definite: then K - l M is so on the shapes that are M-orthogonal to V (Finsler's lemma), and Z counts all
eigenvalues below the level l. One Cholesky decomposition tells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import LinAlgError

from ..arrays import BoolArray, FloatArray
from .exact import Solver

if TYPE_CHECKING:
    from ..kinematics import Configurations

_LIFTED = 100.0  # times the level, added to the shapes V


def nothing_missed(solver: Solver, configurations: Configurations, shapes: FloatArray, level: float) -> BoolArray:
    """Whether Z of the shapes V (n, p) counts all eigenvalues below the level in each of N configurations (N,)."""
    systems = solver.systems(configurations)
    momenta = systems.mass @ shapes
    matrices = [
        stiffness - level * mass + _LIFTED * level * (free.T @ p) @ (p.T @ free)
        for (mass, stiffness, free), p in zip(systems.pencils, momenta, strict=True)
    ]
    return np.array([_is_positive_definite(each) for each in matrices])


def _is_positive_definite(matrix: FloatArray) -> bool:
    diagonal = np.diag(matrix)
    if np.any(diagonal <= 0.0):
        return False
    scale = 1.0 / np.sqrt(diagonal)
    try:
        np.linalg.cholesky(matrix * np.outer(scale, scale))
    except LinAlgError:
        return False
    return True
