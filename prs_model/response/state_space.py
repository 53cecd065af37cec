"""State-space models on the modes, for control design and simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray
from ..errors import MissingExtraError, PrsError
from .damping import DampingLike, damping_of
from .modal_equations import ModalEquations, modal_equations
from .points import point
from .quantity import DIRECTIONS, ComplexArray, Response, check_quantity, frequencies_from
from .residual import is_truncated, residual_compliance, with_residual_vectors
from .time_response import Hold, time_response

if TYPE_CHECKING:
    import scipy.signal

    from ..modes import Modes


@dataclass(frozen=True, eq=False, repr=False)
class StateSpace:
    """x' = A x + B f, y = C x + D f with x = (q, q') of k modes: A (2k, 2k), B (2k, 6), C (6, 2k), D (6, 6), SI.

    inputs: force and moment at one node, outputs: displacement, velocity or acceleration of another, along and about
    u, v, w; their names are such as ``f_u`` and ``x_rw``.
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def __repr__(self) -> str:
        return f"StateSpace({len(self.a)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs)"

    def to_scipy(self) -> scipy.signal.StateSpace:
        """The same for SciPy."""
        from scipy.signal import StateSpace as SciPyStateSpace

        return SciPyStateSpace(self.a, self.b, self.c, self.d)

    def to_control(self) -> Any:
        """The same for python-control, inputs and outputs by name. Raises MissingExtraError."""
        try:
            import control
        except ImportError as error:
            raise MissingExtraError("control", "control", "a python-control model") from error
        return control.ss(self.a, self.b, self.c, self.d, inputs=list(self.inputs), outputs=list(self.outputs))

    def frf(self, frequencies_hz: ArrayLike) -> ComplexArray:
        """C (j omega - A)^-1 B + D (f, 6, 6): what this model makes of the frequency response. Raises PrsError."""
        rates = 2j * np.pi * frequencies_from(frequencies_hz)
        one = np.eye(len(self.a))
        return np.array([self.c @ np.linalg.solve(rate * one - self.a, self.b) + self.d for rate in rates])

    def response(self, forces: ArrayLike, step: float, hold: Hold = "linear") -> FloatArray:
        """Outputs (t, 6) at rest before the first sample, for samples (t, 3) or (t, 6) of the force, `step` [s] apart.

        Exact for forces that are linear between samples, or constant (hold="constant"). Raises PrsError.
        """
        return time_response(self.a, self.b, self.c, self.d, forces, step, hold)


def state_space(
    modes: Modes,
    damping: DampingLike,
    to: str | None,
    at: str | None,
    quantity: Response,
    static_correction: bool | None,
    residual_vectors: bool,
) -> StateSpace:
    """See Modes.state_space."""
    check_quantity(quantity)
    _check_correction(quantity, static_correction, residual_vectors)
    model = damping_of(modes.system, damping)
    ends = point(modes.system, to), point(modes.system, at)
    if residual_vectors and is_truncated(modes):
        modes = with_residual_vectors(modes, np.vstack([end.motion for end in ends]).T)
    equations = modal_equations(modes, model)
    if equations.has_loss:
        raise PrsError(
            "damping: a loss factor holds for steady vibration only and has no model in time; give the joint a viscous "
            "time constant instead, which damps as much at one frequency: viscous = loss_factor / (2 pi f)"
        )
    to_modes, at_modes = (end.motion @ equations.shapes for end in ends)
    k = len(equations.eigenvalues)
    letter, c, d = _outputs(equations, to_modes, at_modes.T, quantity)
    if quantity == "receptance" and static_correction is not False and not residual_vectors:
        d = residual_compliance(modes, *ends)
    return StateSpace(
        np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(equations.eigenvalues), -equations.viscous]]),
        np.vstack([np.zeros((k, 6)), at_modes.T]),
        c,
        d,
        tuple(f"f_{direction}" for direction in DIRECTIONS),
        tuple(f"{letter}_{direction}" for direction in DIRECTIONS),
    )


def _outputs(
    equations: ModalEquations, to: FloatArray, loads: FloatArray, quantity: Response
) -> tuple[str, FloatArray, FloatArray]:
    """The letter of the outputs, C (6, 2 k) and D (6, 6), of displacement, velocity or acceleration."""
    rest, none = np.zeros_like(to), np.zeros((6, 6))
    if quantity == "receptance":
        return "x", np.hstack([to, rest]), none
    if quantity == "mobility":
        return "v", np.hstack([rest, to]), none
    return "a", np.hstack([-to * equations.eigenvalues, -to @ equations.viscous]), np.asarray(to @ loads)


def _check_correction(quantity: Response, static_correction: bool | None, residual_vectors: bool) -> None:
    if static_correction and (quantity != "receptance" or residual_vectors):
        raise PrsError(
            "static_correction: a constant stands for the modes left out in a receptance only; take residual_vectors, "
            "which do so for every quantity, alone"
        )
