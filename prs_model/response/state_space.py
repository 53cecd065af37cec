"""State-space models on the modes, for control design and simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray
from ..errors import MissingExtraError, PrsError
from .damping import DampingLike, damping_of
from .modal_equations import modal_equations
from .points import point
from .quantity import DIRECTIONS, Response, check_quantity
from .residual import residual_compliance
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
    static_correction: bool,
) -> StateSpace:
    """See Modes.state_space."""
    check_quantity(quantity)
    model = damping_of(modes.system, damping)
    equations = modal_equations(modes, model)
    if equations.has_loss:
        raise PrsError(
            "damping: a loss factor holds for steady vibration only and has no model in time; give the joint a viscous "
            "time constant instead, which damps as much at one frequency: viscous = loss_factor / (2 pi f)"
        )
    ends = point(modes.system, to), point(modes.system, at)
    k = len(equations.eigenvalues)
    to_modes, loads = ends[0].motion @ equations.shapes, (ends[1].motion @ equations.shapes).T
    stiffness = equations.eigenvalues
    rest = np.zeros((6, k))
    c = {
        "receptance": np.hstack([to_modes, rest]),
        "mobility": np.hstack([rest, to_modes]),
        "accelerance": np.hstack([-to_modes * stiffness, -to_modes @ equations.viscous]),
    }[quantity]
    d = {
        "receptance": residual_compliance(modes, *ends) if static_correction else np.zeros((6, 6)),
        "mobility": np.zeros((6, 6)),
        "accelerance": to_modes @ loads,
    }[quantity]
    letter = {"receptance": "x", "mobility": "v", "accelerance": "a"}[quantity]
    return StateSpace(
        np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(stiffness), -equations.viscous]]),
        np.vstack([np.zeros((k, 6)), loads]),
        c,
        np.asarray(d),
        tuple(f"f_{direction}" for direction in DIRECTIONS),
        tuple(f"{letter}_{direction}" for direction in DIRECTIONS),
    )
