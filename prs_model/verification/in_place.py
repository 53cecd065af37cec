"""Parts whose contact travels, reduced with the contact where it is.

Between its stations such a part is interpolated, which is no Ritz method: its frequencies may fall below those of the
complete order. Reduced in place it is one, and the bound holds.
"""

from __future__ import annotations

from ..complete_order.stock import full_part
from ..description.settings import Settings
from ..finite_elements import FiniteElementModel
from ..joint_loaded import joint_loaded_parts
from ..kinematics import Configuration
from ..machine import Machine
from ..reduction import SuperElement, TravellingElement
from ..reduction.kinds import Kind, kind_of
from ..reduction.stations import SAME, reduce_in_place, travelling_interface


class InPlace:
    """The parts of a machine, those that travel reduced anew for every configuration; their models are read once."""

    def __init__(self, machine: Machine):
        self.machine = machine
        description, defaults = machine.description, machine.description.file.reduction
        found = {name: travelling_interface(body.interfaces, name) for name, body in description.bodies.items()}
        self.travelling = {name: contact[1] for name, contact in found.items() if contact is not None}
        self._kinds: dict[str, Kind] = {}
        for name in self.travelling:
            body = description.bodies[name]
            stem, settings = description.stems[name], Settings.of(body, defaults)
            self._kinds[name] = kind_of(stem, body, description.folder, settings)
        self._models: dict[Kind, FiniteElementModel] = {}

    def at(self, configuration: Configuration) -> dict[str, SuperElement | TravellingElement]:
        """All parts in a configuration; where the method wants it, loaded by the joints as they are there."""
        made: dict[tuple[Kind, float], SuperElement] = {}
        parts: dict[str, SuperElement | TravellingElement] = dict(self.machine.parts)
        for name, travel in self.travelling.items():
            key = self._kinds[name], round(configuration.joint_values[travel.joint], SAME)
            if key not in made:
                made[key] = self._reduced(name, key[1])
            parts[name] = made[key]
        return joint_loaded_parts(self.machine.description, parts, self.machine.joints, lambda **_: configuration)

    def _reduced(self, name: str, value: float) -> SuperElement:
        description = self.machine.description
        body = description.bodies[name]
        settings = Settings.of(body, description.file.reduction)
        return reduce_in_place(self._model(name), body.interfaces, settings, value, grounded=body.grounded)

    def _model(self, name: str) -> FiniteElementModel:
        kind, description = self._kinds[name], self.machine.description
        if kind not in self._models:
            self._models[kind] = full_part(kind.stem, description.bodies[name], description.folder)
        return self._models[kind]
