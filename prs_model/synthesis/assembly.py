"""Substructure synthesis by Lagrange's equation (eq. 15, 16): bodies on their own coordinates, joints between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description import MachineDescription
from ..description.limbs import limbs_of
from ..errors import PrsError
from ..joints import ElasticJoint, Spring
from ..kinematics import Configuration
from ..reduction import SuperElement, TravellingElement
from .elimination import independent_coordinates
from .ends import Ends
from .system import Coordinate, SpringMotion, System


def assemble(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configuration: Configuration,
) -> System:
    """The system of a machine in one configuration.

    Body matrices stay constant in their body frames; the pose enters only through the springs' displacement maps.
    Rigid joint directions are eliminated exactly; coordinates with neither stiffness nor mass are left out.
    Raises PrsError when the joints leave no coordinate free.
    """
    ends = ends_of(description, parts, configuration)
    springs = [
        spring for joint in joints for spring in joint.springs(configuration.joint_values, configuration.placement)
    ]
    mass, stiffness = _block_diagonal(ends.elements, ends.blocks)
    motions, constraints, sizes = _joined(springs, ends, stiffness)
    mass, stiffness, expansion, kept = _independent(mass, stiffness, constraints, sizes)
    output = description.file.output
    place, rows, reading = ends.output(output, configuration.placement(output.frame))
    labels = _labels(ends.elements)
    return System(
        mass=mass,
        stiffness=stiffness,
        index=tuple(labels[row] for row in kept),
        expansion=expansion,
        blocks=ends.blocks,
        elements=ends.elements,
        springs=motions,
        output=reading @ expansion[rows],
        output_body=output.node.split(".", 1)[0],
        output_placement=place,
        placements=ends.placements,
        configuration=configuration,
        stems=description.stems,
        limbs=limbs_of(description),
        damping_model=description.file.damping,
    )


def wide_joints(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configuration: Configuration,
    share: float = 0.01,
) -> dict[str, float]:
    """Joints whose two ends lie further apart [m] than `share` of the machine's size, which is seldom meant."""
    ends = ends_of(description, parts, configuration)
    points = np.vstack([ends.placements[name].act(r) for name, e in ends.elements.items() for r in e.positions])
    size = float(np.max(np.ptp(points.reshape(-1, 3), axis=0)))
    springs = {joint.name: joint.springs(configuration.joint_values, configuration.placement) for joint in joints}
    gaps = {name: ends.gap(each) for name, each in springs.items() if each}
    return {name: gap for name, gap in gaps.items() if gap > share * size}


def ends_of(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    configuration: Configuration,
) -> Ends:
    """The bodies in a configuration, for reading the motions of joint ends."""
    elements = {name: _at(part, configuration) for name, part in parts.items()}
    placements = {name: configuration.placement(body.frame) for name, body in description.bodies.items()}
    return Ends(elements, _blocks(elements), placements)


def _at(part: SuperElement | TravellingElement, configuration: Configuration) -> SuperElement:
    if isinstance(part, TravellingElement):
        return part.at(configuration.joint_values[part.joint])
    return part


def _blocks(elements: Mapping[str, SuperElement]) -> dict[str, slice]:
    stops = np.cumsum([element.size for element in elements.values()])
    return {
        name: slice(int(stop) - element.size, int(stop))
        for (name, element), stop in zip(elements.items(), stops, strict=True)
    }


def _labels(elements: Mapping[str, SuperElement]) -> list[Coordinate]:
    return [
        Coordinate(name, *label.rsplit(".", 1)) if "." in label else Coordinate(name, "", label)
        for name, element in elements.items()
        for label in element.labels
    ]


def _block_diagonal(elements: Mapping[str, SuperElement], blocks: Mapping[str, slice]) -> tuple[FloatArray, FloatArray]:
    size = sum(element.size for element in elements.values())
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for name, block in blocks.items():
        mass[block, block] = elements[name].mass
        stiffness[block, block] = elements[name].stiffness
    return mass, stiffness


def _joined(
    springs: Sequence[Spring], ends: Ends, stiffness: FloatArray
) -> tuple[tuple[SpringMotion, ...], FloatArray, FloatArray]:
    """Adds the springs to the stiffness (N, N); returns their motions, the rigid rows G (r, N) and the rows' sizes."""
    motions, constraints, sizes = [], [np.zeros((0, len(stiffness)))], [np.zeros(0)]
    for spring in springs:
        relative, rigid = ends.relative_displacement(spring), spring.law.rigid_wrenches
        motions.append(
            SpringMotion(spring.joint, spring.interface, relative.rows, relative.motion, spring.law.stiffness)
        )
        stiffness[np.ix_(relative.rows, relative.rows)] += relative.motion.T @ spring.law.stiffness @ relative.motion
        constraints.append(np.zeros((rigid.shape[1], len(stiffness))))
        constraints[-1][:, relative.rows] = rigid.T @ relative.motion
        sizes.append(np.linalg.norm(np.abs(rigid).T @ relative.size, axis=1))
    return tuple(motions), np.vstack(constraints), np.concatenate(sizes)


def _independent(
    mass: FloatArray, stiffness: FloatArray, constraints: FloatArray, sizes: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """M, K (n, n) on the coordinates that remain, the expansion (N, n), and which coordinates they are (n,)."""
    expansion, kept = independent_coordinates(constraints, sizes)
    if len(kept) < len(mass):
        mass, stiffness = _projected(mass, expansion), _projected(stiffness, expansion)
    present = np.any(mass != 0.0, axis=1) | np.any(stiffness != 0.0, axis=1)
    if not present.any():
        raise PrsError("every coordinate of the machine is held rigidly; nothing can vibrate")
    both = np.ix_(present, present)
    return mass[both], stiffness[both], expansion[:, present], kept[present]


def _projected(matrix: FloatArray, expansion: FloatArray) -> FloatArray:
    projected = expansion.T @ matrix @ expansion
    return np.asarray(0.5 * (projected + projected.T))
