"""The complete-order model of a machine: read and factorized once, solved at any pose."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import plugins
from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.schema import Body, Coupling
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..reduction.interfaces import interface_ties
from ..reduction.made import checked_model
from ..reduction.recipe import Settings
from ..reduction.request import asked
from ..synthesis import System, assemble
from .eigen import Joined, Solution, lowest
from .part import CompletePart, Factorized, factorized, with_interfaces

Contact = tuple[str, tuple[float, ...]]
"""A kind of part, and how far its contact has moved."""

SLOW = 1e-2  # the shift's share of the joints' stiffness over the machine's mass

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class CompleteModes:
    """Modes of the complete order at one pose.

    frequencies (c,) [Hz]. residuals (c,): relative error bounds of the squared frequencies. node_motions (6 k, c): of
    all interface nodes in body axes, mass-normalised, rows as in `system`, which has these nodes and the joints only.
    output_motions (6, c): of the end-reference point, in output axes. size: number of DOFs. iterations: taken.
    """

    frequencies: FloatArray
    residuals: FloatArray
    node_motions: FloatArray
    output_motions: FloatArray
    system: System
    size: int
    iterations: int


class CompleteOrder:
    """The full finite-element model of a machine's assembly, with the interfaces of joints averaged or rigid.

    Parts are read and factorized when first needed, each kind once. Every interface has nodes of its own, also where
    the machine's reduction ties several to one.
    """

    def __init__(
        self, description: MachineDescription, joints: tuple[ElasticJoint, ...], coupling: Coupling = "averaged"
    ):
        self.description, self.joints = description, joints
        self.settings = Settings(coupling, "interface", 0)
        self._models: dict[str, FiniteElementModel] = {}
        self._factorized: dict[str, Factorized] = {}
        self._parts: dict[Contact, CompletePart] = {}
        self._shift: float | None = None

    def modes(self, configuration: Configuration, count: int = 8) -> CompleteModes:
        """The lowest modes in a configuration.

        Raises PartFileError for a part that comes reduced, PrsError when the iteration does not come to rest.
        """
        bodies, shift = self.parts(configuration), self._shift_for(configuration)
        stand_ins = {name: part.stand_in(self.description.bodies[name].grounded) for name, part in bodies.items()}
        system = assemble(self.description, stand_ins, self.joints, configuration)
        joined = Joined(bodies, system.stiffness, system.expansion, shift)
        logger.info("complete order: %d DOFs, %d interface nodes", joined.size, len(system.expansion) // 6)
        return _modes(joined, lowest(joined, count), system)

    def parts(self, configuration: Configuration) -> dict[str, CompletePart]:
        """The part of every body, with its interfaces where they are in a configuration. Raises PartFileError."""
        shift = self._shift_for(configuration)
        here: dict[Contact, CompletePart] = {}
        return {name: self._part(name, configuration, shift, here) for name in self.description.bodies}

    def _shift_for(self, configuration: Configuration) -> float:
        """s < 0 [rad^2/s^2], slow beside the joints, to hold free parts a little; the first pose decides."""
        if self._shift is None:
            values, placement = configuration.joint_values, configuration.placement
            springs = [spring for joint in self.joints for spring in joint.springs(values, placement)]
            stiffness = sum(float(np.trace(spring.law.stiffness[:3, :3])) for spring in springs)
            mass = sum(self._model(name).mass_properties().mass for name in self.description.bodies)
            self._shift = -SLOW * stiffness / mass
        return self._shift

    def _model(self, name: str) -> FiniteElementModel:
        """The full matrices of a body, those of identical limbs once. Raises PartFileError for a reduced part."""
        stem, body = self.description.stems[name], self.description.bodies[name]
        if stem not in self._models:
            self._models[stem] = full_part(stem, body, self.description.folder)
        return self._models[stem]

    def _part(
        self, name: str, configuration: Configuration, shift: float, here: dict[Contact, CompletePart]
    ) -> CompletePart:
        """The part of a body; one whose contact travels is kept for this configuration only, in `here`."""
        stem, body = self.description.stems[name], self.description.bodies[name]
        moved = _moved_contact(body, configuration)
        kept, key = (self._parts, (stem, ())) if moved is None else (here, (stem, tuple(np.round(moved, 12))))
        if key not in kept:
            model = self._model(name)
            if stem not in self._factorized:
                self._factorized[stem] = factorized(model, shift)
            ties = interface_ties(model, body.interfaces, self.settings, np.zeros(3) if moved is None else moved)
            kept[key] = with_interfaces(self._factorized[stem], ties, shift)
        return kept[key]


def full_part(name: str, body: Body, folder: Path) -> FiniteElementModel:
    """The full matrices of a body, past the physics gate, with what it clamps held.

    Raises PartFileError for one that comes reduced, and what reading and the gate raise.
    """
    request = asked(name, body, folder)[1]
    part = plugins.read(body.reducer, request)
    if not isinstance(part, FiniteElementModel):
        raise PartFileError(request.source or name, f"{name} comes reduced: the complete order needs full matrices")
    logger.info("%s: %d DOFs", name, part.size)
    return checked_model(part, body, name, str(request.source or name))


def _modes(joined: Joined, solution: Solution, system: System) -> CompleteModes:
    motions = joined.node_motions(solution.vectors)
    independent = np.linalg.lstsq(system.expansion, motions, rcond=None)[0]
    return CompleteModes(
        frequencies=np.sqrt(np.maximum(solution.eigenvalues, 0.0)) / (2.0 * np.pi),
        residuals=solution.residuals,
        node_motions=motions,
        output_motions=system.output @ independent,
        system=system,
        size=joined.size,
        iterations=solution.iterations,
    )


def _moved_contact(body: Body, configuration: Configuration) -> FloatArray | None:
    """How far (3,) [m] the travelling interface of a body has moved; None for a body that has none."""
    for interface in body.interfaces.values():
        if (travel := interface.travel) is not None:
            direction = np.array(travel.along, dtype=float)
            return np.asarray(direction / np.linalg.norm(direction) * configuration.joint_values[travel.joint])
    return None
