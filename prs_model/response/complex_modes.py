"""Complex modes: free vibration under any damping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eig
from scipy.optimize import linear_sum_assignment

from ..arrays import FloatArray
from .damping import Damping, is_proportional, modal_ratios
from .modal_equations import ModalEquations, modal_equations
from .quantity import ComplexArray

if TYPE_CHECKING:
    from ..modes import Modes
    from ..synthesis import System

_ROUND_OFF = 1e-12  # of a damping ratio
_ALIKE = 0.5  # of a complex mode's size: it is the real mode's, turned by damping
_STILL = 1e-6  # of the first elastic rate: what is slower is rigid motion and its round-off


@dataclass(frozen=True, eq=False, repr=False)
class ComplexModes:
    """Motions psi e^(s t): poles s (k,) [rad/s] with positive imaginary part, |s| ascending, and shapes psi (n, k).

    psi^H M psi = 1, and the phase is that in which psi is as real as can be: without damping psi are the real modes.
    """

    system: System
    poles: ComplexArray
    shapes: ComplexArray

    def __repr__(self) -> str:
        listed = zip(self.frequencies, self.damping_ratios, strict=True)
        return f"ComplexModes({', '.join(f'{f:.4g} Hz {ratio:.2%}' for f, ratio in listed)})"

    @property
    def frequencies(self) -> FloatArray:
        """|s| / 2 pi (k,) [Hz]: for proportional damping the undamped frequencies."""
        return np.asarray(np.abs(self.poles) / (2.0 * np.pi))

    @property
    def damping_ratios(self) -> FloatArray:
        """-Re s / |s| (k,), round-off as 0; half the loss factor where that is small and the same everywhere."""
        ratios = -self.poles.real / np.abs(self.poles)
        return np.asarray(np.where(np.abs(ratios) < _ROUND_OFF, 0.0, ratios))

    @property
    def output_shapes(self) -> ComplexArray:
        """(6, k): motion of the end-reference point in the output frame, translations first."""
        return self.system.output @ self.shapes

    @property
    def collinearity(self) -> FloatArray:
        """|psi^T M psi| (k,): 1 where all points move in phase or against it, as in a real mode; less otherwise."""
        return np.asarray(np.abs(np.einsum("ik,ij,jk->k", self.shapes, self.system.mass, self.shapes, optimize=True)))


def complex_modes(system: System, count: int, damping: Damping) -> ComplexModes:
    """The `count` slowest solutions of (s^2 M + s C + K + j H) psi = 0 that oscillate, fewer where there are fewer.

    Solved on all real modes, where M is the identity. Rigid motions and overdamped ones are left out.
    """
    modes = system.modes(system.size)
    equations = modal_equations(modes, damping)
    poles, vectors = eig(_companion(equations))
    slow = np.sqrt(np.min(equations.eigenvalues, where=equations.eigenvalues > 0.0, initial=np.inf))
    oscillates = np.flatnonzero(poles.imag > np.maximum(_STILL * slow, 1e-9 * np.abs(poles)))
    chosen = oscillates[np.argsort(np.abs(poles[oscillates]), kind="stable")][:count]
    return ComplexModes(
        system, poles[chosen], equations.shapes @ _normalised(vectors[: len(equations.eigenvalues), chosen])
    )


def ratios_of(modes: Modes, damping: Damping) -> FloatArray:
    """xi (k,) of real modes: where joints damp, of the complex modes nearest in the M inner product, which are theirs.

    nan for rigid-body modes, and for modes that damping keeps from oscillating.
    """
    if is_proportional(damping):
        return modal_ratios(damping, modes.eigenvalues)
    damped = complex_modes(modes.system, modes.system.size, damping)
    likeness = np.abs(modes.shapes.T @ modes.system.mass @ damped.shapes)
    likeness[modes.is_rigid] = 0.0
    ratios = np.full(len(modes.eigenvalues), np.nan)
    for mode, partner in zip(*linear_sum_assignment(likeness, maximize=True), strict=True):
        if likeness[mode, partner] > _ALIKE:
            ratios[mode] = damped.damping_ratios[partner]
    return ratios


def _companion(equations: ModalEquations) -> FloatArray | ComplexArray:
    """A (2 k, 2 k) of (q, q')' = A (q, q')."""
    k = len(equations.eigenvalues)
    stiffness = np.diag(equations.eigenvalues)
    held = stiffness + 1j * equations.loss if equations.has_loss else stiffness
    return np.block([[np.zeros((k, k)), np.eye(k)], [-held, -equations.viscous]])


def _normalised(q: ComplexArray) -> ComplexArray:
    """Columns of unit length, turned so that q^T q is real and above zero and the largest entry is positive."""
    q = q / np.linalg.norm(q, axis=0)
    q = q * np.exp(-0.5j * np.angle((q**2).sum(axis=0)))
    largest = q[np.argmax(np.abs(q), axis=0), np.arange(q.shape[1])].real
    return np.asarray(q * np.where(largest < 0.0, -1.0, 1.0))
