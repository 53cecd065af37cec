"""Substructure synthesis by Lagrange's equation (eq. 15, 16): bodies on their own coordinates, joints between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description import MachineDescription
from ..description.limbs import limbs_of
from ..errors import PrsError
from ..joints import ElasticJoint, Spring
from ..kinematics import Configuration, Configurations
from ..reduction import Elements, SuperElement, TravellingElement
from .elimination import independent_coordinates
from .ends import Ends, RelativeDisplacement
from .system import Coordinate, SpringMotion, System

Bodies: TypeAlias = Mapping[str, SuperElement] | Mapping[str, Elements]


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
    elements = elements_at(parts, configuration)
    ends = ends_of(description, elements, configuration)
    mass, stiffness = block_diagonal(elements, ends.blocks)
    motions, constraints, sizes = joined(springs_of(joints, configuration), ends, stiffness)
    mass, stiffness, expansion, kept = _independent(mass, stiffness, constraints, sizes)
    output = description.file.output
    place, rows, reading = ends.output(output, configuration.placement(output.frame))
    labels = _labels(elements)
    return System(
        mass=mass,
        stiffness=stiffness,
        index=tuple(labels[row] for row in kept),
        expansion=expansion,
        blocks=ends.blocks,
        elements=elements,
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
    elements = elements_at(parts, configuration)
    ends = ends_of(description, elements, configuration)
    points = np.vstack([ends.placements[name].act(r) for name, e in elements.items() for r in e.positions])
    size = float(np.max(np.ptp(points.reshape(-1, 3), axis=0)))
    springs = {joint.name: joint.springs(configuration.joint_values, configuration.placement) for joint in joints}
    gaps = {name: ends.gap(each) for name, each in springs.items() if each}
    return {name: gap for name, gap in gaps.items() if gap > share * size}


def elements_at(
    parts: Mapping[str, SuperElement | TravellingElement], configuration: Configuration
) -> dict[str, SuperElement]:
    """Every part where its contacts are in a configuration."""
    values = configuration.joint_values
    return {
        name: part.at(values[part.joint]) if isinstance(part, TravellingElement) else part
        for name, part in parts.items()
    }


def ends_of(
    description: MachineDescription,
    elements: Bodies,
    configuration: Configuration | Configurations,
) -> Ends:
    """The bodies in a configuration, or in many, for reading the motions of joint ends."""
    placements = {name: configuration.placement(body.frame) for name, body in description.bodies.items()}
    return Ends(elements, _blocks(elements), placements)


def springs_of(joints: Sequence[ElasticJoint], configuration: Configuration | Configurations) -> list[Spring]:
    """The springs of all joints in a configuration, or in many."""
    values = configuration.joint_values
    return [spring for joint in joints for spring in joint.springs(values, configuration.placement)]


def _blocks(elements: Bodies) -> dict[str, slice]:
    sizes = [element.mass.shape[-1] for element in elements.values()]
    stops = np.cumsum(sizes).tolist()
    return {name: slice(stop - size, stop) for name, size, stop in zip(elements, sizes, stops, strict=True)}


def _labels(elements: Mapping[str, SuperElement]) -> list[Coordinate]:
    return [
        Coordinate(name, *label.rsplit(".", 1)) if "." in label else Coordinate(name, "", label)
        for name, element in elements.items()
        for label in element.labels
    ]


def block_diagonal(
    elements: Bodies, blocks: Mapping[str, slice], many: tuple[int, ...] = ()
) -> tuple[FloatArray, FloatArray]:
    """M and K (N, N) of the bodies apart from each other; or a stack of as `many`."""
    size = max(block.stop for block in blocks.values())
    mass, stiffness = np.zeros((*many, size, size)), np.zeros((*many, size, size))
    for name, block in blocks.items():
        mass[..., block, block] = elements[name].mass
        stiffness[..., block, block] = elements[name].stiffness
    return mass, stiffness


def joined(
    springs: Sequence[Spring], ends: Ends, stiffness: FloatArray
) -> tuple[tuple[SpringMotion, ...], FloatArray, FloatArray]:
    """Adds the springs to the stiffness (N, N), or to a stack.

    Returns their motions, the rigid rows G (r, N) and what these were before terms cancelled, their sizes (r,).
    """
    *many, _, size = stiffness.shape
    motions, constraints, sizes = [], [np.zeros((*many, 0, size))], [np.zeros((*many, 0))]
    for spring in springs:
        relative, law = ends.relative_displacement(spring), spring.law
        motions.append(SpringMotion(spring.joint, spring.interface, relative.blocks, relative.motions, law.stiffness))
        if law.rigid_wrenches.shape[-1]:
            rows, size_of_rows = _rigid_rows(law.rigid_wrenches, relative, stiffness.shape)
            constraints.append(rows)
            sizes.append(size_of_rows)
    _stiffen(stiffness, motions)
    return tuple(motions), np.concatenate(constraints, axis=-2), np.concatenate(sizes, axis=-1)


def _stiffen(stiffness: FloatArray, springs: Sequence[SpringMotion]) -> None:
    """K + sum D^T k D. Summed by pairs of bodies, so that the large matrices are written once."""
    sums: dict[tuple[int, int, int, int], FloatArray] = {}
    for spring in springs:
        if not spring.stiffness.any():
            continue
        ends = list(zip(spring.blocks, spring.motions, strict=True))
        for place, (block, motion) in enumerate(ends):
            force = _transposed(motion) @ spring.stiffness
            for other, other_motion in ends[place:]:
                pair = (block.start, block.stop, other.start, other.stop)
                sums[pair] = sums.get(pair, 0.0) + force @ other_motion
    for (top, bottom, left, right), coupling in sums.items():
        stiffness[..., top:bottom, left:right] += coupling
        if left != top:
            stiffness[..., left:right, top:bottom] += _transposed(coupling)


def _rigid_rows(
    wrenches: FloatArray, relative: RelativeDisplacement, shape: tuple[int, ...]
) -> tuple[FloatArray, FloatArray]:
    """G (r, N) of the rigid directions of a spring, and the sizes (r,), where `shape` is that of the stiffness."""
    rigid = _transposed(wrenches)
    rows = np.zeros((*shape[:-2], rigid.shape[-2], shape[-1]))
    squares = np.zeros(rows.shape[:-1])
    for block, motion, size in zip(relative.blocks, relative.motions, relative.sizes, strict=True):
        rows[..., block] = rigid @ motion
        squares += np.sum((np.abs(rigid) @ size) ** 2, axis=-1)
    return rows, np.sqrt(squares)


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


def _transposed(matrix: FloatArray) -> FloatArray:
    return np.swapaxes(matrix, -1, -2)


def _projected(matrix: FloatArray, expansion: FloatArray) -> FloatArray:
    projected = expansion.T @ matrix @ expansion
    return np.asarray(0.5 * (projected + projected.T))
