"""Frequency responses (eq. 18-20): by superposition of modes, and directly, a solve for each frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .damping import Damping, is_proportional, loss_joints, viscous_matrix
from .modal_equations import ModalEquations, modal_equations
from .points import Point
from .quantity import ComplexArray
from .residual import is_truncated, with_residual_vectors

if TYPE_CHECKING:
    from ..modes import Modes
    from ..synthesis import System


def modal_receptance(
    modes: Modes, frequencies: FloatArray, damping: Damping, to: Point, at: Point, static_correction: bool
) -> ComplexArray:
    """H (f, 6, 6) = sum_k phi_to phi_at^T / (omega_k^2 - omega^2 + 2 j xi_k omega_k omega), eq. (18, 19).

    The damping term has the j that print lost in eq. (20). Joints that damp couple the modes: their equations are then
    solved together, for each frequency. static_correction makes up for the modes left out by residual vectors; these
    know nothing of what joints do to such modes, so that with joints that damp the system itself is solved.
    """
    if static_correction and is_truncated(modes):
        if not is_proportional(damping):
            return direct_receptance(modes.system, frequencies, damping, to, at)
        modes = with_residual_vectors(modes, np.vstack([to.motion, at.motion]).T)
    omega = 2.0 * np.pi * frequencies
    equations = modal_equations(modes, damping)
    to_modes, at_modes = to.motion @ equations.shapes, at.motion @ equations.shapes
    if equations.is_coupled:
        stiffness = np.diag(equations.eigenvalues) + 1j * equations.loss
        return _solved(stiffness, equations.viscous, np.eye(len(stiffness)), omega, to_modes, at_modes.T)
    return np.asarray(np.einsum("ik,fk,jk->fij", to_modes, _resonances(equations, omega), at_modes, optimize=True))


def direct_receptance(system: System, frequencies: FloatArray, damping: Damping, to: Point, at: Point) -> ComplexArray:
    """H (f, 6, 6) = R_to (K + j H - omega^2 M + j omega C)^-1 R_at^T, eq. (18), nothing truncated."""
    scale = 1.0 / np.sqrt(np.diag(positive_definite_pencil(system.mass, system.stiffness)[1]))
    scaling = np.outer(scale, scale)
    stiffness = scaling * (system.stiffness + 1j * loss_joints(system, damping))
    viscous = scaling * viscous_matrix(system, damping)
    omega = 2.0 * np.pi * frequencies
    loads = scale[:, None] * at.motion.T
    return _solved(stiffness, viscous, scaling * system.mass, omega, to.motion * scale, loads)


def _resonances(equations: ModalEquations, omega: FloatArray) -> ComplexArray:
    """(f, k): the answer of each mode to a unit modal force."""
    rates = np.diag(equations.viscous)
    dynamic = equations.eigenvalues - omega[:, None] ** 2 + 1j * omega[:, None] * rates
    if np.any(dynamic == 0.0):
        raise _infinite(omega[np.any(dynamic == 0.0, axis=1)][0])
    return np.asarray(1.0 / dynamic)


def _solved(
    stiffness: FloatArray | ComplexArray,
    viscous: FloatArray,
    mass: FloatArray,
    omega: FloatArray,
    to: FloatArray,
    loads: FloatArray,
) -> ComplexArray:
    """(f, 6, 6): to (6, n) (K - omega^2 M + j omega C)^-1 loads (n, 6), one dense factorization for each omega (f,)."""
    receptance = np.empty((len(omega), len(to), loads.shape[1]), dtype=complex)
    for row, rate in zip(receptance, omega, strict=True):
        dynamic = stiffness - rate**2 * mass + 1j * rate * viscous
        try:
            row[:] = to @ np.linalg.solve(dynamic, loads)
        except np.linalg.LinAlgError:
            raise _infinite(rate) from None
    return receptance


def _infinite(omega: float) -> PrsError:
    return PrsError(
        f"at {omega / (2.0 * np.pi):g} Hz an undamped mode resonates and the response is infinite; give damping, or "
        "another frequency"
    )
