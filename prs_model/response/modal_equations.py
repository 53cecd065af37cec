"""The equations of motion on the modes: q'' + D q' + (Lambda + j H) q = Phi^T f."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..modes.clusters import parted_shapes
from .damping import Damping, has_loss_factors, is_proportional, loss_joints, modal_rates, viscous_joints

if TYPE_CHECKING:
    from ..modes import Modes


@dataclass(frozen=True, eq=False)
class ModalEquations:
    """Lambda (k,) [rad^2/s^2], D (k, k) [1/s] and H (k, k) [rad^2/s^2] of mass-normalised shapes Phi (n, k).

    is_coupled: D or H has terms off the diagonal. has_loss: H is not zero.
    """

    shapes: FloatArray
    eigenvalues: FloatArray
    viscous: FloatArray
    loss: FloatArray
    is_coupled: bool
    has_loss: bool


def modal_equations(modes: Modes, damping: Damping) -> ModalEquations:
    """What the modes are subject to under a damping."""
    system = modes.system
    shapes = parted_shapes(system.stiffness, modes.frequencies, modes.shapes)
    eigenvalues = np.where(modes.is_rigid, 0.0, modes.eigenvalues)
    return ModalEquations(
        shapes,
        eigenvalues,
        np.diag(modal_rates(damping, eigenvalues)) + viscous_joints(system, damping, shapes),
        loss_joints(system, damping, shapes),
        not is_proportional(damping),
        has_loss_factors(damping),
    )


def damping_ratios(modes: Modes, damping: Damping) -> FloatArray:
    """xi (k,) by the diagonal of Phi^T (omega C + H) Phi over 2 omega^2; nan for rigid-body modes.

    Exactly those of modal ratios and Rayleigh's constants; where joints damp, those of complex modes to first order.
    """
    equations = modal_equations(modes, damping)
    elastic = equations.eigenvalues > 0.0
    omega = np.sqrt(equations.eigenvalues[elastic])
    ratios = np.full(len(elastic), np.nan)
    ratios[elastic] = (np.diag(equations.viscous)[elastic] + np.diag(equations.loss)[elastic] / omega) / (2.0 * omega)
    return ratios
