"""The complete-order model of a machine: read and factorized once, solved at any pose."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass

from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.schema import Coupling
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..modes import Modes
from ..reduction.super_element import SuperElement
from ..synthesis import System, assemble
from .eigen import lowest
from .inverse import Joined
from .part import CompletePart
from .stock import Stock
from .subspace import enlarged, pictured, rigid_motions

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class CompleteModes:
    """Modes of the complete order at one pose.

    modes: with energies, characters and surfaces as those of a reduced system have them. Their coordinates are each
    body's rigid motions and its shapes in these very modes, so nothing else of that system is to be relied on.
    residuals (c,): relative error bounds of the squared frequencies. size: number of DOFs. iterations: taken.
    """

    modes: Modes
    residuals: FloatArray
    size: int
    iterations: int

    @property
    def frequencies(self) -> FloatArray:
        """(c,) [Hz]."""
        return self.modes.frequencies


class CompleteOrder:
    """The full finite-element model of a machine's assembly, with the interfaces of joints averaged or rigid.

    Parts are read and factorized when first needed, each kind once. Every interface has nodes of its own, also where
    the machine's reduction ties several to one.
    """

    def __init__(
        self, description: MachineDescription, joints: tuple[ElasticJoint, ...], coupling: Coupling = "averaged"
    ):
        self.description, self.joints = description, joints
        self._stock = Stock(description, joints, coupling)

    def modes(self, configuration: Configuration, count: int = 8) -> CompleteModes:
        """The lowest modes in a configuration.

        Raises PartFileError for a part that comes reduced, PrsError when the iteration does not come to rest.
        """
        spaces = self._stock.subspaces(configuration)
        joined = self._joined({name: space.part for name, space in spaces.items()}, configuration)
        logger.info("complete order: %d DOFs, %d interface nodes", joined.size, len(joined.expansion) // 6)
        solution = lowest(joined, spaces, lambda elements: self._assembled(elements, configuration), count)
        logger.info("complete order: %d modes, iterations: %d", count, solution.iterations)
        elements = {
            name: pictured(enlarged(rigid_motions(part), solution.shapes[name])) for name, part in joined.bodies.items()
        }
        modes = self._assembled(elements, configuration).modes(count)
        return CompleteModes(modes, solution.residuals, joined.size, solution.iterations)

    def joined(self, configuration: Configuration) -> Joined:
        """The parts of all bodies, with their interfaces where they are in a configuration, and what joins them.

        Raises PartFileError for a part that comes reduced.
        """
        parts = {name: space.part for name, space in self._stock.subspaces(configuration).items()}
        return self._joined(parts, configuration)

    def _joined(self, parts: Mapping[str, CompletePart], configuration: Configuration) -> Joined:
        system = self._assembled({name: part.stand_in() for name, part in parts.items()}, configuration)
        return Joined(parts, system.stiffness, system.expansion)

    def _assembled(self, elements: Mapping[str, SuperElement], configuration: Configuration) -> System:
        return assemble(self.description, elements, self.joints, configuration)
