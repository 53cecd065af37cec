"""The machine solved at poses one by one: nodes of an interpolation, samples, and what is left to the dense solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ..arrays import FloatArray, IntArray
from ..synthesis import DualSystems, Systems, assemble_many, dual_assembly
from .low_modes import LowModes, low_modes
from .threads import cores

if TYPE_CHECKING:
    from ..kinematics import Configurations
    from ..machine import Machine

CHUNK = 48  # configurations assembled at once: 40 MB at 200 coordinates

_SMALLEST = 4  # of a chunk

_T = TypeVar("_T")


@dataclass(frozen=True, eq=False)
class Solved:
    """Configurations with their systems and lowest modes."""

    configurations: Configurations
    systems: Systems
    modes: LowModes


@dataclass(frozen=True, eq=False)
class Solver:
    """Solves a machine for its `count` lowest modes, from a shift below all eigenvalues [rad^2/s^2]."""

    machine: Machine
    count: int
    shift: float

    def solve(self, configurations: Configurations) -> Solved:
        """A chunk of configurations, each of which exists. Raises PrsError for a singular system, or beyond travel."""
        systems = self.systems(configurations)
        return Solved(configurations, systems, low_modes(systems, self.count, self.shift))

    def systems(self, configurations: Configurations) -> Systems:
        """The systems in a chunk of configurations."""
        machine = self.machine
        return assemble_many(machine.description, machine.parts, machine.joints, configurations)

    def dual(self, configurations: Configurations) -> DualSystems:
        """The dual form in a chunk of configurations."""
        machine = self.machine
        return dual_assembly(machine.description, machine.parts, machine.joints, configurations)

    def each(self, poses: FloatArray, what: Callable[[Solved], _T], pool: ThreadPoolExecutor) -> Iterator[_T]:
        """`what` of the solved poses (N, d), chunk by chunk in order, on all cores.

        Raises PrsError where a pose has no configuration.
        """
        return pool.map(lambda chunk: what(self.solve(chunk)), self._chunks(poses))

    def each_dual(self, poses: FloatArray, what: Callable[[DualSystems], _T], pool: ThreadPoolExecutor) -> Iterator[_T]:
        """As `each`, of dual forms."""
        return pool.map(lambda chunk: what(self.dual(chunk)), self._chunks(poses))

    def _chunks(self, poses: FloatArray) -> list[Configurations]:
        found = self.machine.kinematics.solve_batch(poses)
        if np.isnan(found.q).any():
            raise found.errors[int(np.flatnonzero(np.isnan(found.q).any(axis=1))[0])]
        size = min(CHUNK, max(_SMALLEST, -(-len(poses) // cores())))
        return [part(found, slice(start, start + size)) for start in range(0, len(poses), size)]


def eigenvalues_of(solved: Sequence[Solved]) -> FloatArray:
    """(N, k) of all of them, as many as each has."""
    fewest = min(each.modes.eigenvalues.shape[1] for each in solved)
    return np.concatenate([each.modes.eigenvalues[:, :fewest] for each in solved])


def part(configurations: Configurations, some: slice | IntArray) -> Configurations:
    """Some of the configurations, limits left aside."""
    c = configurations
    return replace(c, poses=c.poses[some], q=c.q[some], closure_residual=c.closure_residual[some], errors={})
