"""Static compliance by a solve, and what a truncated modal sum lacks of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .points import Point

if TYPE_CHECKING:
    from ..modes import Modes
    from ..synthesis import System


def static_compliance(system: System, to: Point, at: Point) -> FloatArray:
    """C = R_to K^-1 R_at^T (6, 6) [m/N, rad/N, 1/N, rad/(N m)], exact: what the modal sum of eq. (21) tends to.

    Raises PrsError when the machine can move without straining anything.
    """
    shift, pencil = positive_definite_pencil(system.mass, system.stiffness)
    if shift != 0.0:
        raise PrsError(
            "the machine can move without straining anything, so that it has no static compliance; expected every body "
            "to be held by joints or drives (prs-model modes shows what moves at 0 Hz)"
        )
    return np.asarray(to.motion @ _solved(pencil, at.motion.T))


def residual_compliance(modes: Modes, to: Point, at: Point) -> FloatArray:
    """(6, 6): the modes left out, sum phi phi^T / lambda over them, by a solve; zero when none is.

    The load is purged of what the kept modes take, r = (1 - M Phi Phi^T) R_at^T, and K^-1 r has no share of them. A
    structure that is free has K - s M in place of K, s so small that only its rigid-body modes notice.
    Raises PrsError unless these are all among the kept ones.
    """
    system = modes.system
    if modes.shapes.shape[1] == system.size:
        return np.zeros((6, 6))
    shift, pencil = positive_definite_pencil(system.mass, system.stiffness)
    if shift != 0.0 and modes.is_rigid.all():
        raise PrsError(
            f"found {modes.shapes.shape[1]} modes, all at 0 Hz, expected some above them; ask for more modes"
        )
    load = at.motion.T - system.mass @ (modes.shapes @ (modes.shapes.T @ at.motion.T))
    return np.asarray(to.motion @ _solved(pencil, load))


def _solved(matrix: FloatArray, sides: FloatArray) -> FloatArray:
    """Positive definite A^-1 b, scaled so that metres and radians do not matter."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    factor = cho_factor(matrix * np.outer(scale, scale))
    return np.asarray(scale[:, None] * cho_solve(factor, scale[:, None] * sides))
