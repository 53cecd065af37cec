"""The parts of a machine as its joints hold them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..description import MachineDescription
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..reduction import SuperElement, TravellingElement
from ..synthesis.assembly import elements_at, ends_of
from .grips import grips
from .held import Held

Part = SuperElement | TravellingElement


@dataclass(frozen=True, eq=False)
class Holding:
    """The parts and joints of a machine, these as stiff as they are in the reference configuration."""

    description: MachineDescription
    parts: Mapping[str, Part]
    joints: Sequence[ElasticJoint]
    reference: Configuration

    def held(self, name: str, at: Configuration) -> Held:
        """A part as it is held in a configuration; one whose contact does not travel is held alike in all, nearly."""
        where = at if isinstance(self.parts[name], TravellingElement) else self.reference
        return self._held(name, where, self.parts)

    def at_stations(self, name: str) -> list[Held]:
        """A part whose contact travels, as it is held with the contact at each of its stations."""
        part = self.parts[name]
        assert isinstance(part, TravellingElement)
        places = [self.reference.moved({part.joint: value}) for value in part.stations.tolist()]
        pairs = zip(places, part.elements, strict=True)
        return [self._held(name, place, {**self.parts, name: element}) for place, element in pairs]

    def _held(self, name: str, where: Configuration, parts: Mapping[str, Part]) -> Held:
        elements = elements_at(parts, where)
        ends = ends_of(self.description, elements, where)
        return Held(elements[name], grips(name, self.joints, ends, where, self.reference))
