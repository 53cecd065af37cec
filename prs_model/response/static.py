"""Static compliance by a solve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .points import Point

if TYPE_CHECKING:
    from ..synthesis import System


def static_compliance(system: System, to: Point, at: Point) -> FloatArray:
    """C = R_to K^-1 R_at^T (6, 6) [m/N, rad/N, 1/N, rad/(N m)], exact: what the modal sum of eq. (21) tends to.

    Raises PrsError when the machine can move without straining anything.
    """
    return np.asarray(to.motion @ static_motion(system, at))


def static_motion(system: System, at: Point) -> FloatArray:
    """K^-1 R_at^T (n, 6): how the system gives way to a unit force or moment along and about u, v, w.

    Raises PrsError when the machine can move without straining anything.
    """
    shift, pencil = positive_definite_pencil(system.mass, system.stiffness)
    if shift != 0.0:
        raise PrsError(
            "the machine can move without straining anything, so that it has no static compliance; expected every body "
            "to be held by joints or drives (prs-model modes shows what moves at 0 Hz)"
        )
    return solved_scaled(pencil, at.motion.T)


def solved_scaled(matrix: FloatArray, sides: FloatArray) -> FloatArray:
    """Positive definite A^-1 b, scaled so that metres and radians do not matter."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    factor = cho_factor(matrix * np.outer(scale, scale))
    return np.asarray(scale[:, None] * cho_solve(factor, scale[:, None] * sides))
