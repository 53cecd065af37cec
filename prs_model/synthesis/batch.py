"""Substructure synthesis in many configurations at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..description import MachineDescription
from ..description.limbs import limbs_of
from ..joints import ElasticJoint
from ..kinematics import Configurations
from ..reduction import Elements, SuperElement, TravellingElement
from .assembly import block_diagonal, ends_of, joined, springs_of
from .elimination import independent_coordinates
from .system import SpringMotion

Pencil = tuple[FloatArray, FloatArray, FloatArray]
"""(M, K, T) on independent coordinates v, with u = T v; T has a row for each body coordinate."""


@dataclass(frozen=True, eq=False)
class Systems:
    """M u'' + K u = f with G u = 0 in N configurations, on all n body coordinates: rows as `blocks`, body axes, SI.

    mass, stiffness (N, n, n). constraints (N, r, n): the rigid directions G; rows may be redundant, and one whose norm
    is round-off beside its `constraint_sizes` (N, r) constrains nothing. output (N, 6, n) reads the end-reference
    point, a node of `output_body`, in the axes of the output frame; it stands at `output_placement` (N, 4, 4).
    springs: displacements (N, 6, k) and stiffnesses (N, 6, 6). elements: matrices (N, ..), or (1, ..) where they are
    the same in all. `stems` names the kind of each body and joint, `limbs` the limb of those that are in one.
    """

    mass: FloatArray
    stiffness: FloatArray
    constraints: FloatArray
    constraint_sizes: FloatArray
    output: FloatArray
    springs: tuple[SpringMotion, ...]
    elements: Mapping[str, Elements]
    blocks: Mapping[str, slice]
    output_body: str
    output_placement: FloatArray
    stems: Mapping[str, str]
    limbs: Mapping[str, str]

    def __len__(self) -> int:
        return len(self.mass)

    @cached_property
    def pencils(self) -> tuple[Pencil, ...]:
        """Of each configuration."""
        used = np.any(self.mass != 0.0, axis=(0, 1)) | np.any(self.stiffness != 0.0, axis=(0, 1))
        pairs = zip(self.mass, self.stiffness, strict=True)
        if self.constraints.shape[1]:
            rigid = zip(self.constraints, self.constraint_sizes, strict=True)
            return tuple(_held(*pair, *rows, used) for pair, rows in zip(pairs, rigid, strict=True))
        free = np.eye(len(used))[:, used]
        if used.all():
            return tuple((mass, stiffness, free) for mass, stiffness in pairs)
        both = np.ix_(used, used)
        return tuple((mass[both], stiffness[both], free) for mass, stiffness in pairs)


def assemble_many(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configurations: Configurations,
) -> Systems:
    """The systems of a machine in N configurations, as `assemble` makes them before rigid directions are eliminated.

    Memory: two matrices (n, n) for each configuration, and about as much again for the springs' motions.
    Raises UnreachablePoseError of the first pose that is not reachable, and PrsError where joints change their number
    of rigid or free directions from one configuration to another.
    """
    for error in configurations.errors.values():
        raise error
    count = len(configurations)
    elements = elements_in(parts, configurations)
    ends = ends_of(description, elements, configurations)
    mass, stiffness = block_diagonal(elements, ends.blocks, (count,))
    motions, constraints, sizes = joined(springs_of(joints, configurations), ends, stiffness)
    place, rows, reading = ends.output(description.file.output, configurations.placement(description.file.output.frame))
    output = np.zeros((count, 6, mass.shape[-1]))
    output[..., rows] = reading
    return Systems(
        mass=mass,
        stiffness=stiffness,
        constraints=constraints,
        constraint_sizes=sizes,
        output=output,
        springs=tuple(_stacked(motion, count) for motion in motions),
        elements=elements,
        blocks=ends.blocks,
        output_body=description.file.output.node.split(".", 1)[0],
        output_placement=np.broadcast_to(place.homogeneous, (count, 4, 4)),
        stems=description.stems,
        limbs=limbs_of(description),
    )


def elements_in(
    parts: Mapping[str, SuperElement | TravellingElement], configurations: Configurations
) -> dict[str, Elements]:
    """Every part where its contacts are in many configurations."""
    values = configurations.joint_values
    return {
        name: part.at_many(values[part.joint]) if isinstance(part, TravellingElement) else Elements.of(part)
        for name, part in parts.items()
    }


def _stacked(motion: SpringMotion, count: int) -> SpringMotion:
    """With an entry for every configuration, also where all are the same."""
    motions = tuple(
        each if len(each) == count else np.broadcast_to(each, (count, *each.shape[-2:])) for each in motion.motions
    )
    return replace(motion, motions=motions, stiffness=np.broadcast_to(motion.stiffness, (count, 6, 6)))


def _held(mass: FloatArray, stiffness: FloatArray, rows: FloatArray, sizes: FloatArray, used: BoolArray) -> Pencil:
    free, kept = independent_coordinates(rows, sizes)
    free = free[:, used[kept]]
    return free.T @ mass @ free, free.T @ stiffness @ free, free
