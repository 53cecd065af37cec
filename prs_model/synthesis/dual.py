"""Dual assembly: the bodies apart from each other, and the wrenches in the joints as unknowns.

Let K_0 and M be those of the bodies alone, B u the relative displacements along the wrenches that the joints transmit,
and C the joints' compliance, zero where they are rigid. Without the displacements, (K - s M) u = f is

    S phi = B (K_0 - s M)^-1 f,    S = C + B (K_0 - s M)^-1 B^T

(de Klerk, Rixen & Voormeeren, AIAA Journal 46, 2008). S has a row for each transmitted wrench, however large the parts
are, and its entries are smooth in the pose wherever eigenvalues of the machine are: only those of a body alone, at s,
would give it a pole. Of the machine's eigenvalues as many lie below s as of its bodies, less the negative ones of S
(Haynsworth, Linear Algebra Appl. 1, 1968).

Motions that have neither mass nor stiffness in their body are unknowns too: rows (0, -B^T) below the others. As B^T phi
= 0 along them, a multiple of B B^T may be added to S; where the body has coordinates that strain, it is, so that S is
positive definite on the wrenches below all eigenvalues.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description import MachineDescription
from ..joints import ElasticJoint
from ..kinematics import Configurations
from ..reduction import Elements, SuperElement, TravellingElement
from .assembly import ends_of, springs_of
from .batch import elements_in
from .massless import massless_motions


class Coordinates(NamedTuple):
    """Of a body: those that have mass or stiffness (n',), those that only joints hold (e,), and how far the former go
    with the latter (n', e) so that nothing strains or has momentum."""

    own: IntArray
    held: IntArray
    along: FloatArray


@dataclass(frozen=True, eq=False)
class DualSystems:
    """A machine in N configurations, joint wrenches phi (c,) as unknowns, SI.

    joints: that which transmits each of the c wrenches. compliances: of each spring its wrenches (m,) and C (N, m, m),
    or (1, m, m) where it is the same in all. bodies: of each body the wrenches (k,) that act on it and their
    B (N, k, n), or (1, k, n).
    """

    count: int
    joints: tuple[str, ...]
    compliances: tuple[tuple[IntArray, FloatArray], ...]
    bodies: Mapping[str, tuple[IntArray, FloatArray]]
    elements: Mapping[str, Elements]

    def __len__(self) -> int:
        return self.count

    @property
    def size(self) -> int:
        """Number of rows of S: wrenches, and coordinates that only joints hold."""
        return len(self.joints) + sum(len(each.held) for each in self.coordinates.values())

    def at(self, shift: float, keeping: bool = False) -> tuple[FloatArray, IntArray]:
        """S (N, r, r) at a shift s [rad^2/s^2], r the c wrenches and the coordinates that only joints hold; and numbers
        (N,) to subtract its negative eigenvalues from, which leaves the number of the machine's eigenvalues below s.

        keeping: bodies whose matrices follow the pose keep their coordinates among the unknowns, in further rows; no
        eigenvalue of theirs then makes a pole of S in the pose.
        Raises numpy.linalg.LinAlgError where the shift is an eigenvalue of another body alone.
        """
        kept = self._kept if keeping else {}
        size = self.size + sum(map(len, kept.values()))
        S, place = np.zeros((self.count, size, size)), self.size
        below = np.full(self.count, size - len(self.joints))
        for rows, columns, values in self.entries():
            S[:, rows, columns] += values
            S[:, columns, rows] += np.where(rows == columns, 0.0, values)
        for name, (rows, reading) in self.bodies.items():
            if name in kept:
                own, element = kept[name], self.elements[name]
                apart = np.arange(place, place := place + len(own))
                S[:, apart[:, None], apart] = -(element.stiffness - shift * element.mass)[:, own[:, None], own]
                S[:, rows[:, None], apart] = -reading[..., own]
                S[:, apart[:, None], rows] = -_transposed(reading[..., own])
                continue
            root, pivots = self.decoupled(name, shift)
            below = below + (pivots < 0.0).sum(axis=1)
            moved = reading[..., self.coordinates[name].own] @ root
            _add(S, rows, (moved / pivots[:, None]) @ _transposed(moved))
        return S, below

    @property
    def _kept(self) -> dict[str, IntArray]:
        """The coordinates of bodies whose matrices follow the pose."""
        return {name: each.own for name, each in self.coordinates.items() if len(self.elements[name].mass) > 1}

    def entries(self) -> Iterator[tuple[IntArray, IntArray, FloatArray]]:
        """What S holds at any shift, below its diagonal and on it: rows (m,), columns (m,), values (N or 1, m)."""
        for wrenches, compliance in self.compliances:
            i, j = np.tril_indices(len(wrenches))
            yield wrenches[i], wrenches[j], compliance[:, i, j]
        place = len(self.joints)
        for name, (rows, reading) in self.bodies.items():
            own, held, along = self.coordinates[name]
            alone = np.arange(place, place := place + len(held))
            felt = reading[..., held] + reading[..., own] @ along
            yield np.repeat(alone, len(rows)), np.tile(rows, len(held)), -_transposed(felt).reshape(len(reading), -1)
            stiff = np.diag(self.elements[name].stiffness[0])[held]
            added = (felt * np.divide(1.0, stiff, out=np.zeros(len(held)), where=stiff > 0.0)) @ _transposed(felt)
            i, j = np.tril_indices(len(rows))
            if np.any(added):
                yield rows[i], rows[j], added[:, i, j]

    def decoupled(self, name: str, shift: float) -> tuple[FloatArray, FloatArray]:
        """X (N, n', n') and d (N, n') of a body with X^T (K_0 - s M) X = diag(d), on the coordinates that have mass or
        stiffness; N is 1 where its matrices are the same in all configurations.

        Raises numpy.linalg.LinAlgError where the shift is an eigenvalue of the body alone.
        """
        element, some = self.elements[name], self.coordinates[name].own
        mass, stiffness = (each[:, some[:, None], some] for each in (element.mass, element.stiffness))
        sizes = np.diagonal(stiffness, axis1=1, axis2=2) + abs(shift) * np.diagonal(mass, axis1=1, axis2=2)
        scale = 1.0 / np.sqrt(sizes)
        pivots, turn = np.linalg.eigh((stiffness - shift * mass) * scale[:, :, None] * scale[:, None])
        if np.any(np.abs(pivots) <= np.finfo(float).eps):
            raise np.linalg.LinAlgError(f"{name}: the shift is one of its eigenvalues")
        return scale[:, :, None] * turn, pivots

    @cached_property
    def coordinates(self) -> dict[str, Coordinates]:
        """Of each body; those that have neither mass nor stiffness nor move a joint are left out."""
        found: dict[str, Coordinates] = {}
        for name, (_, reading) in self.bodies.items():
            element = self.elements[name]
            some = np.any(element.mass, axis=(0, 1)) | np.any(element.stiffness, axis=(0, 1))
            alone = np.flatnonzero(~some & np.any(reading, axis=(0, 1)))
            own, led, along = massless_motions(element.mass, element.stiffness, np.flatnonzero(some))
            along = np.concatenate([along, np.zeros((len(own), len(alone)))], axis=1)
            found[name] = Coordinates(own, np.append(led, alone), along)
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
    compliances = []
    names = {block.start: name for name, block in ends.blocks.items()}
    on: dict[str, list[tuple[IntArray, FloatArray]]] = {name: [] for name in elements}
    for spring, stop in zip(springs, stops, strict=True):
        rows = np.arange(stop - spring.law.wrenches.shape[-1], stop)
        compliances.append((rows, np.atleast_3d(spring.law.compliance.T).T))
        relative = ends.relative_displacement(spring)
        for block, motion in zip(relative.blocks, relative.motions, strict=True):
            on[names[block.start]].append((rows, _transposed(spring.law.wrenches) @ motion))
    return DualSystems(
        count=len(configurations),
        joints=tuple(each.joint for each in springs for _ in range(each.law.wrenches.shape[-1])),
        compliances=tuple(compliances),
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


def _add(S: FloatArray, rows: IntArray, block: FloatArray) -> None:
    """S[:, rows, rows] += block, by runs of successive rows."""
    cuts = [0, *(np.flatnonzero(np.diff(rows) != 1) + 1).tolist(), len(rows)]
    runs = [(slice(start, stop), slice(rows[start], rows[stop - 1] + 1)) for start, stop in pairwise(cuts) if stop]
    for here, there in runs:
        for across, beside in runs:
            S[:, there, beside] += block[:, here, across]
