"""Parts whose contact travels, reduced with the contact where it is.

Between its stations such a part is interpolated, which is no Ritz method: its frequencies may fall below those of the
complete order. Reduced in place it is one, and the bound holds.
"""

from __future__ import annotations

import numpy as np

from ..complete_order.stock import full_part
from ..description.settings import Settings
from ..finite_elements import FiniteElementModel
from ..joint_loaded import joint_loaded_parts
from ..kinematics import Configuration
from ..machine import Machine
from ..reduction import SuperElement, TravellingElement
from ..reduction.contact import reduction_per_station
from ..reduction.from_model import AWAITS_JOINTS
from ..reduction.interfaces import interface_ties
from ..reduction.stations import travelling_interface

_SAME = 9  # decimals of a joint value [m] up to which two contacts are at one place


class InPlace:
    """The parts of a machine, those that travel reduced anew for every configuration; their models are read once."""

    def __init__(self, machine: Machine):
        self.machine = machine
        bodies = machine.description.bodies
        found = {name: travelling_interface(body.interfaces, name) for name, body in bodies.items()}
        self.travelling = {name: contact for name, contact in found.items() if contact is not None}
        self._models: dict[str, FiniteElementModel] = {}

    def at(self, configuration: Configuration) -> dict[str, SuperElement | TravellingElement]:
        """All parts in a configuration; where the method wants it, loaded by the joints as they are there."""
        description = self.machine.description
        made: dict[tuple[str, float], SuperElement] = {}
        moved: dict[str, SuperElement | TravellingElement] = {}
        for name, (_, travel) in self.travelling.items():
            stroke = round(configuration.joint_values[travel.joint], _SAME)
            key = description.stems[name], stroke
            if key not in made:
                made[key] = self._reduced(name, stroke)
            moved[name] = made[key]
        moved = joint_loaded_parts(description, moved, self.machine.joints, lambda: configuration)
        return {name: moved.get(name, part) for name, part in self.machine.parts.items()}

    def _reduced(self, name: str, stroke: float) -> SuperElement:
        description = self.machine.description
        body, (contact, travel) = description.bodies[name], self.travelling[name]
        model, settings = self._model(name), Settings.of(body, description.file.reduction)
        direction = np.array(travel.along, dtype=float)
        shift = direction / np.linalg.norm(direction) * stroke
        ties = interface_ties(model, body.interfaces, settings, shift=shift)
        moving = {tie.node for tie in interface_ties(model, {contact: body.interfaces[contact]}, settings, shift=shift)}
        moves = np.array([tie.node in moving for tie in ties])
        basis = AWAITS_JOINTS if settings.method == "joint-loaded" else "craig-bampton"
        elements, _ = reduction_per_station(model, [ties], moves, settings.modes, body.grounded, basis)
        return elements[0]

    def _model(self, name: str) -> FiniteElementModel:
        description = self.machine.description
        stem, body = description.stems[name], description.bodies[name]
        if stem not in self._models:
            self._models[stem] = full_part(stem, body, description.folder)
        return self._models[stem]
