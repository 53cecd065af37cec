"""The complete-order model of a machine: read and factorized once, solved at any pose."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.schema import Coupling
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..modes.modes import Modes, check_count
from ..reduction.super_element import SuperElement
from ..synthesis import System, assemble
from .cache import Solved, kept
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
    residuals (c,): relative error bounds of the squared frequencies. size: number of DOFs. iterations: taken. seconds:
    that solving took, the parts' factorization included where this pose was the first; earlier, if from a cache.
    """

    modes: Modes
    residuals: FloatArray
    size: int
    iterations: int
    seconds: float

    @property
    def frequencies(self) -> FloatArray:
        """(c,) [Hz]."""
        return self.modes.frequencies


class CompleteOrder:
    """The full finite-element model of a machine's assembly, with the interfaces of joints averaged or rigid.

    Parts are read and factorized when first needed, each kind once; travelling ones with rigid interfaces anew for
    every stroke. Every member of an interface has a node of its own, also where the machine's reduction, or the
    interface's `tie`, has one for several; an interface's own `coupling` is kept. cache: a folder where solved poses
    are kept by their content.
    """

    def __init__(
        self,
        description: MachineDescription,
        joints: tuple[ElasticJoint, ...],
        coupling: Coupling = "averaged",
        cache: Path | None = None,
    ):
        self.description, self.joints, self.cache = description, joints, cache
        self._stock = Stock(description, joints, coupling)

    def modes(self, configuration: Configuration, count: int = 8) -> CompleteModes:
        """The lowest modes in a configuration.

        Raises PartFileError for a part that comes reduced, PrsError when `count` is no whole number above zero or the
        iteration does not come to rest.
        """
        check_count(count)
        solved = self._solved(configuration, count) if self.cache is None else self._found(configuration, count)
        modes = self._assembled(solved.elements, configuration).modes(count)
        return CompleteModes(modes, solved.residuals, solved.size, solved.iterations, solved.seconds)

    def joined(self, configuration: Configuration) -> Joined:
        """The parts of all bodies, with their interfaces where they are in a configuration, and what joins them.

        Raises PartFileError for a part that comes reduced.
        """
        parts = {name: space.part for name, space in self._stock.subspaces(configuration).items()}
        return self._joined(parts, configuration)

    def _found(self, configuration: Configuration, count: int) -> Solved:
        """The modes out of the cache, where they are put if they were not there."""
        place = kept(Path(self.cache or ""), self._stock, configuration, count)
        if (solved := place.find()) is None:
            place.keep(solved := self._solved(configuration, count))
        return solved

    def _solved(self, configuration: Configuration, count: int) -> Solved:
        start = perf_counter()
        spaces = self._stock.subspaces(configuration)
        joined = self._joined({name: space.part for name, space in spaces.items()}, configuration)
        logger.info("complete order: %d DOFs, %d interface nodes", joined.size, len(joined.expansion) // 6)
        solution = lowest(joined, spaces, lambda elements: self._assembled(elements, configuration), count)
        logger.info("complete order: %d modes, iterations: %d", count, solution.iterations)
        elements = {
            name: pictured(enlarged(rigid_motions(part), solution.shapes[name])) for name, part in joined.bodies.items()
        }
        return Solved(elements, solution.residuals, joined.size, solution.iterations, perf_counter() - start)

    def _joined(self, parts: Mapping[str, CompletePart], configuration: Configuration) -> Joined:
        system = self._assembled({name: part.stand_in() for name, part in parts.items()}, configuration)
        return Joined(parts, system.stiffness, system.expansion)

    def _assembled(self, elements: Mapping[str, SuperElement], configuration: Configuration) -> System:
        return assemble(self.description, elements, self.joints, configuration)
