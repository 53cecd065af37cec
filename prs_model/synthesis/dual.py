"""Dual assembly: the bodies apart from each other, and the wrenches in the joints as unknowns.

Let K_0 and M be those of the bodies alone, B u the relative displacements along the wrenches that the joints transmit,
and C the joints' compliance, zero where they are rigid. Without the displacements, (K - s M) u = f is

    S phi = B (K_0 - s M)^-1 f,    S = C + B (K_0 - s M)^-1 B^T

(de Klerk, Rixen & Voormeeren, AIAA Journal 46, 2008). S has a row for each transmitted wrench, however large the parts
are, and its entries are smooth in the pose wherever eigenvalues of the machine are: only those of a body alone, at s,
would give it a pole. Of the machine's eigenvalues as many lie below s as of its bodies, less the negative ones of S
(Haynsworth, Linear Algebra Appl. 1, 1968).

Coordinates that have neither mass nor stiffness in their body are unknowns too: rows (0, -B^T) below the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description import MachineDescription
from ..joints import ElasticJoint
from ..kinematics import Configurations
from ..reduction import Elements, SuperElement, TravellingElement
from .assembly import ends_of, springs_of
from .batch import elements_in


@dataclass(frozen=True, eq=False)
class DualSystems:
    """A machine in N configurations, joint wrenches phi (c,) as unknowns, SI.

    joints: that which transmits each of the c wrenches. compliance (N, c, c). bodies: of each body the wrenches (k,)
    that act on it and their B (N, k, n), or (1, k, n) where it is the same in all.
    """

    joints: tuple[str, ...]
    compliance: FloatArray
    bodies: Mapping[str, tuple[IntArray, FloatArray]]
    elements: Mapping[str, Elements]

    def __len__(self) -> int:
        return len(self.compliance)

    def at(self, shift: float) -> tuple[FloatArray, IntArray]:
        """S (N, c + e, c + e) with e coordinates that only joints hold, at a shift s [rad^2/s^2]; and numbers (N,) to
        subtract its negative eigenvalues from, which leaves the number of the machine's eigenvalues below s.

        Raises numpy.linalg.LinAlgError where the shift is an eigenvalue of a body alone.
        """
        count, c = len(self), len(self.joints)
        size = c + sum(len(held) for _, held in self._coordinates.values())
        S, below = np.zeros((count, size, size)), np.full(count, size - c)
        S[:, :c, :c] = self.compliance
        place = c
        for name, (rows, reading) in self.bodies.items():
            element, (some, held) = self.elements[name], self._coordinates[name]
            pencil = (element.stiffness - shift * element.mass)[:, some[:, None], some]
            below = below + (np.linalg.eigvalsh(pencil) < 0.0).sum(axis=1)
            moved = reading[..., some]
            S[:, rows[:, None], rows] += moved @ np.linalg.solve(pencil, _transposed(moved))
            alone = np.arange(place, place := place + len(held))
            S[:, rows[:, None], alone] = -reading[..., held]
            S[:, alone[:, None], rows] = -_transposed(reading[..., held])
        return (S + _transposed(S)) / 2.0, below

    @property
    def rows(self) -> tuple[str, ...]:
        """Of each row of S its joint, or whose coordinate it is."""
        return (*self.joints, *(f"{name}'s" for name, (_, held) in self._coordinates.items() for _ in held))

    @cached_property
    def _coordinates(self) -> Mapping[str, tuple[IntArray, IntArray]]:
        """Of each body those with mass or stiffness, and those without that move a joint."""
        found = {}
        for name, (_, reading) in self.bodies.items():
            element = self.elements[name]
            own = np.any(element.mass, axis=(0, 1)) | np.any(element.stiffness, axis=(0, 1))
            found[name] = (np.flatnonzero(own), np.flatnonzero(~own & np.any(reading, axis=(0, 1))))
        return found


def dual_assembly(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configurations: Configurations,
) -> DualSystems:
    """The dual form of a machine in N configurations, all reachable.

    Raises PrsError where joints change their number of rigid or free directions from one configuration to another.
    """
    elements = elements_in(parts, configurations)
    ends = ends_of(description, elements, configurations)
    springs = [each for each in springs_of(joints, configurations) if each.law.wrenches.shape[-1]]
    stops = np.cumsum([each.law.wrenches.shape[-1] for each in springs]).tolist()
    compliance = np.zeros((len(configurations), stops[-1], stops[-1]))
    names = {block.start: name for name, block in ends.blocks.items()}
    on: dict[str, list[tuple[IntArray, FloatArray]]] = {name: [] for name in elements}
    for spring, stop in zip(springs, stops, strict=True):
        rows = np.arange(stop - spring.law.wrenches.shape[-1], stop)
        compliance[:, rows[:, None], rows] = spring.law.compliance
        relative = ends.relative_displacement(spring)
        for block, motion in zip(relative.blocks, relative.motions, strict=True):
            on[names[block.start]].append((rows, _transposed(spring.law.wrenches) @ motion))
    return DualSystems(
        joints=tuple(each.joint for each in springs for _ in range(each.law.wrenches.shape[-1])),
        compliance=compliance,
        bodies={name: _together(parts, elements[name].size) for name, parts in on.items()},
        elements=elements,
    )


def _together(parts: Sequence[tuple[IntArray, FloatArray]], size: int) -> tuple[IntArray, FloatArray]:
    if not parts:
        return np.zeros(0, dtype=np.int64), np.zeros((1, 0, size))
    many = max(len(reading) for _, reading in parts)
    readings = [np.broadcast_to(each, (many, *each.shape[-2:])) for _, each in parts]
    return np.concatenate([rows for rows, _ in parts]), np.concatenate(readings, axis=1)


def _transposed(matrix: FloatArray) -> FloatArray:
    return np.swapaxes(matrix, -1, -2)
