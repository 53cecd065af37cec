"""Damping models and their matrices.

Ratios of the modes or Rayleigh's constants, and joints, which add to either.

* **Proportional** (modal ratios, Rayleigh): C = M Phi diag(2 xi omega) Phi^T M or alpha M + beta K. The real modes stay
  those of the undamped machine, and modal superposition (eq. 18-20) is exact.
* **Viscous joints**: C_j = tau K_j (Kelvin-Voigt, time constant tau [s]). Modes are coupled by C: complex modes.
* **Loss factors**: K_j (1 + j eta), whatever the frequency. Complex modes; a model of steady vibration only, since it
  would answer before the force in time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from ..arrays import FloatArray
from ..description.messages import report
from ..description.problems import Problems
from ..description.schema import Damping as Damping
from ..errors import PrsError, UnknownNameError
from ..modes.clusters import parted_shapes
from .quantity import real_numbers

if TYPE_CHECKING:
    from ..synthesis import System
    from ..synthesis.system import SpringMotion

DampingLike = Damping | Mapping[str, Any] | float | Sequence[float] | FloatArray | None
"""A damping ratio, one for each mode, entries as in machine.yaml's `damping` in SI, or None for the machine's own."""


def damping_of(system: System, given: DampingLike = None) -> Damping:
    """The damping that holds. Raises PrsError for ratios below 0 or not below 1, or entries that make no sense."""
    if given is None:
        return system.damping_model
    damping = given if isinstance(given, Damping) else _validated(_entries(given))
    if damping.modal is not None and damping.rayleigh is not None:
        raise PrsError("damping: found modal and rayleigh, expected one of the two; keep one")
    known = dict.fromkeys(name for spring in system.springs for name in _names(system, spring))
    for name in damping.joints:
        if name not in known:
            raise UnknownNameError("joint in damping", name, list(known))
    return damping


def modal_ratios(damping: Damping, eigenvalues: FloatArray) -> FloatArray:
    """xi (k,) of modes with eigenvalues (k,) [rad^2/s^2], without what joints add; nan for rigid-body modes, at 0.

    Of a list of ratios the first is that of the first mode that is not rigid; further modes have the last one.
    """
    elastic = eigenvalues > 0.0
    omega = np.sqrt(eigenvalues[elastic])
    if damping.rayleigh is not None:
        found = 0.5 * (damping.rayleigh.alpha / omega + damping.rayleigh.beta * omega)
    else:
        given = np.atleast_1d(np.array(damping.modal if damping.modal is not None else 0.0, dtype=float))
        found = given[np.minimum(np.arange(len(omega)), len(given) - 1)]
    ratios = np.full(len(eigenvalues), np.nan)
    ratios[elastic] = found
    return ratios


def modal_rates(damping: Damping, eigenvalues: FloatArray) -> FloatArray:
    """Diagonal (k,) [1/s] of Phi^T C Phi without what joints add: 2 xi omega, or alpha + beta omega^2."""
    if damping.rayleigh is not None:
        return np.asarray(damping.rayleigh.alpha + damping.rayleigh.beta * eigenvalues)
    return np.nan_to_num(2.0 * modal_ratios(damping, eigenvalues) * np.sqrt(eigenvalues))


def viscous_matrix(system: System, damping: Damping) -> FloatArray:
    """C (n, n): Rayleigh's, or M Phi diag(2 xi omega) Phi^T M over all modes; and tau_j K_j of the joints."""
    joints = viscous_joints(system, damping)
    if damping.rayleigh is not None:
        return np.asarray(damping.rayleigh.alpha * system.mass + damping.rayleigh.beta * system.stiffness + joints)
    if not np.any(damping.modal):
        return joints
    modes = system.modes(system.size)
    momentum = system.mass @ parted_shapes(system.stiffness, modes.frequencies, modes.shapes)
    rates = modal_rates(damping, modes.eigenvalues)
    return np.asarray((momentum * rates) @ momentum.T + joints)


def viscous_joints(system: System, damping: Damping, shapes: FloatArray | None = None) -> FloatArray:
    """sum tau_j K_j (n, n), or projected on shapes (n, k)."""
    return _joint_sum(system, {name: float(each.viscous or 0.0) for name, each in damping.joints.items()}, shapes)


def loss_joints(system: System, damping: Damping, shapes: FloatArray | None = None) -> FloatArray:
    """sum eta_j K_j (n, n), or projected on shapes (n, k): the imaginary part of the stiffness."""
    return _joint_sum(system, {name: float(each.loss_factor or 0.0) for name, each in damping.joints.items()}, shapes)


def has_loss_factors(damping: Damping) -> bool:
    """Whether the stiffness is complex, so that there is no model in time."""
    return any(each.loss_factor for each in damping.joints.values())


def is_proportional(damping: Damping) -> bool:
    """Whether the undamped modes are those of the damped machine."""
    return not any(each.viscous or each.loss_factor for each in damping.joints.values())


def in_words(damping: Damping) -> str:
    """Such as ``damping 2 %`` or ``damping 1, 3 %; joints R, S damp``."""
    said = []
    if damping.modal is not None and np.any(damping.modal):
        said.append(f"damping {', '.join(f'{100.0 * each:g}' for each in np.atleast_1d(damping.modal))} %")
    if damping.rayleigh is not None:
        said.append(f"damping alpha {damping.rayleigh.alpha:g} 1/s, beta {damping.rayleigh.beta:g} s")
    joints = [name for name, each in damping.joints.items() if each.viscous or each.loss_factor]
    if joints:
        said.append(f"joint{'s' if len(joints) > 1 else ''} {', '.join(joints)} damp{'' if len(joints) > 1 else 's'}")
    return "; ".join(said) or "no damping"


def _joint_sum(system: System, factors: Mapping[str, float], shapes: FloatArray | None) -> FloatArray:
    size = system.size if shapes is None else shapes.shape[1]
    total = np.zeros((size, size))
    for spring in system.springs:
        factor = next((factors[name] for name in _names(system, spring) if name in factors), 0.0)
        if factor:
            expansion = system.expansion[spring.rows]
            strain = spring.displacement @ (expansion if shapes is None else expansion @ shapes)
            total += factor * strain.T @ spring.stiffness @ strain
    return total


def _names(system: System, spring: SpringMotion) -> Iterator[str]:
    """What a joint goes by, its own name before that of its kind."""
    yield spring.joint
    yield system.stems.get(spring.joint, spring.joint)


def _entries(given: Mapping[str, Any] | float | Sequence[float] | FloatArray) -> Mapping[str, Any]:
    if isinstance(given, Mapping):
        return {name: _plain(value) for name, value in given.items()}
    expected = "a ratio such as 0.025, one for each mode, or entries as in the file"
    ratios = real_numbers("damping", given, expected)
    if ratios.ndim > 1:
        raise PrsError(f"damping: found an array of shape {ratios.shape}, expected {expected}")
    return {"modal": tuple(ratios.tolist()) if ratios.ndim else ratios.item()}


def _plain(value: Any) -> Any:
    """As a file would have it: tuples for lists and arrays."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    return tuple(_plain(each) for each in value) if isinstance(value, list | tuple) else value


def _validated(entries: Mapping[str, Any]) -> Damping:
    """Entries of a `damping` section in SI. Raises PrsError, a sentence for each that is wrong."""
    try:
        return Damping.model_validate(entries)
    except ValidationError as error:
        problems = Problems("", {})
        report(error, Damping, entries, problems, ("damping",))
        sentences = [f"{each.entry}: {each.message}" for each in problems.in_file_order()]
        raise PrsError("; ".join(sentences)) from error
