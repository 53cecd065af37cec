"""Everything the report shows of one pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..readable import pose_text
from ..response.band import band
from ..response.damping import damping_of, is_proportional, modal_ratios
from ..response.modal_equations import damping_ratios

if TYPE_CHECKING:
    from ..description.schema import Damping
    from ..machine import Machine
    from ..modes import Modes
    from ..modes.character import Character
    from ..modes.energy import Energies
    from ..response import DampingLike, FrequencyResponse, WeakMode

_SAME = 1e-9  # m or rad between poses that are one


@dataclass(frozen=True, eq=False)
class AtRest:
    """Of a machine that is held: compliance (6, 6) of the end-reference point, what each mode gives to it (k, 6)
    [m/N, rad/(N m)], the same as shares of the compliance, and the weak modes."""

    compliance: FloatArray
    flexibility: FloatArray
    shares: FloatArray
    weak: tuple[WeakMode, ...]


@dataclass(frozen=True, eq=False)
class Study:
    """One pose [m, rad], numbered from 1: its modes, their damping ratios (k,), how the end-reference point answers.

    at_rest and response are None where the machine can move without straining anything, or nothing oscillates.
    ratios are None where joints damp, so that the modes are complex. kinetic, strain, joint_strain: shares of each
    mode's energy, as Modes.kinetic_energy, strain_energy and joint_strain_by_direction give them.
    """

    number: int
    pose: Mapping[str, float]
    text: str
    is_reference: bool
    modes: Modes
    characters: tuple[Character, ...]
    kinetic: Energies
    strain: Energies
    joint_strain: Energies
    damping: Damping
    ratios: FloatArray | None
    at_rest: AtRest | None
    response: FrequencyResponse | None

    @property
    def folder(self) -> str:
        """Name of the pose's folder."""
        return f"pose_{self.number}"


def study(machine: Machine, pose: Mapping[str, float], number: int, count: int, damping: DampingLike = None) -> Study:
    """Solve one pose for so many modes. The response is of all modes, whatever the count.

    damping: as in Modes.frf. Raises UnreachablePoseError, or PrsError for damping that makes no sense.
    """
    configuration = machine.configuration(**pose)
    system = machine.assemble(configuration)
    modes = system.modes(count)
    model = damping_of(system, damping)
    return Study(
        number=number,
        pose=configuration.pose,
        text=pose_text(configuration.pose, machine.kinematics.task.coordinates) or "the only pose",
        is_reference=all(abs(configuration.pose[k] - value) < _SAME for k, value in machine.reference_pose.items()),
        modes=modes,
        characters=modes.characters(),
        kinetic=modes.kinetic_energy(),
        strain=modes.strain_energy(),
        joint_strain=modes.joint_strain_by_direction(),
        damping=model,
        ratios=modal_ratios(model, modes.eigenvalues) if is_proportional(model) else None,
        at_rest=_at_rest(modes),
        response=_response(modes, model),
    )


def _at_rest(modes: Modes) -> AtRest | None:
    if modes.is_rigid.any():
        return None
    shares = modes.flexibility_shares()
    return AtRest(modes.static_compliance(), modes.modal_flexibility(), shares, modes.weak_modes())


def _response(modes: Modes, damping: Damping) -> FrequencyResponse | None:
    shown = int(np.sum(~modes.is_rigid))
    if not shown:
        return None
    every = modes.system.modes(modes.system.size)
    return every.frequency_response(band(every, damping_ratios(every, damping), shown), damping)
