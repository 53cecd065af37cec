"""Substructure synthesis by Lagrange's equation (eq. 15, 16): bodies on their own coordinates, joints between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..description import MachineDescription
from ..errors import PrsError
from ..joints import Spring, springs
from ..kinematics import Configuration
from ..reduction import SuperElement, TravellingElement
from .elimination import independent_coordinates
from .system import Coordinate, SpringMotion, System


def assemble(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    configuration: Configuration,
) -> System:
    """The system of a machine in one configuration.

    Body matrices stay constant in their body frames; the pose enters through the springs' displacement maps.
    Rigid joint directions are eliminated exactly; coordinates with neither stiffness nor mass are left out.
    Raises PrsError when the joints leave no coordinate free.
    """
    elements = {name: _at(part, configuration) for name, part in parts.items()}
    blocks = _blocks(elements)
    size = sum(element.stiffness.shape[0] for element in elements.values())
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for name, element in elements.items():
        mass[blocks[name], blocks[name]] = element.mass
        stiffness[blocks[name], blocks[name]] = element.stiffness

    placements = {name: configuration.placement(body.frame) for name, body in description.bodies.items()}
    ends = _Ends(elements, blocks, placements)
    motions, constraints = [], [np.zeros((0, size))]
    for spring in _all_springs(description, configuration):
        rows, displacement = ends.relative_displacement(spring)
        motion = SpringMotion(spring.joint, spring.interface, rows, displacement, spring.law.stiffness)
        motions.append(motion)
        stiffness[np.ix_(rows, rows)] += displacement.T @ motion.stiffness @ displacement
        rigid = spring.law.rigid_wrenches.T @ displacement
        constraints.append(np.zeros((len(rigid), size)))
        constraints[-1][:, rows] = rigid

    expansion, kept = independent_coordinates(np.vstack(constraints))
    if len(kept) < size:
        mass, stiffness = _project(mass, expansion), _project(stiffness, expansion)
    present = (np.abs(mass).sum(axis=1) > 0) | (np.abs(stiffness).sum(axis=1) > 0)
    if not present.any():
        raise PrsError("every coordinate of the machine is held rigidly; nothing can vibrate")
    expansion, kept = expansion[:, present], kept[present]
    rows, reading = ends.output(description, configuration)
    labels = _labels(elements)
    return System(
        mass=mass[np.ix_(present, present)],
        stiffness=stiffness[np.ix_(present, present)],
        index=tuple(labels[row] for row in kept),
        expansion=expansion,
        blocks=blocks,
        elements=elements,
        springs=tuple(motions),
        output=reading @ expansion[rows],
        output_rotation=configuration.placement(description.file.output.frame).rotation,
        placements=placements,
        configuration=configuration,
        stems=description.stems,
        damping_model=description.file.damping,
    )


def _at(part: SuperElement | TravellingElement, configuration: Configuration) -> SuperElement:
    if isinstance(part, TravellingElement):
        return part.at(configuration.joint_values[part.joint])
    return part


def _blocks(elements: Mapping[str, SuperElement]) -> dict[str, slice]:
    blocks, start = {}, 0
    for name, element in elements.items():
        blocks[name] = slice(start, start + element.stiffness.shape[0])
        start = blocks[name].stop
    return blocks


def _labels(elements: Mapping[str, SuperElement]) -> list[Coordinate]:
    return [
        Coordinate(name, *label.rsplit(".", 1)) if "." in label else Coordinate(name, "", label)
        for name, element in elements.items()
        for label in element.labels
    ]


def _all_springs(description: MachineDescription, configuration: Configuration) -> Iterable[Spring]:
    for name, joint in description.joints.items():
        yield from springs(name, joint, description.urdf, dict(configuration.joint_values), configuration.placement)


def _project(matrix: FloatArray, expansion: FloatArray) -> FloatArray:
    projected = expansion.T @ matrix @ expansion
    return np.asarray(0.5 * (projected + projected.T))


class _Ends:
    """Reads the motion of joint ends and of the output point from the body coordinates."""

    def __init__(
        self,
        elements: Mapping[str, SuperElement],
        blocks: Mapping[str, slice],
        placements: Mapping[str, pin.SE3],
    ):
        self._elements, self._blocks, self._placements = elements, blocks, placements

    def relative_displacement(self, spring: Spring) -> tuple[IntArray, FloatArray]:
        """Rows (k,) and D (6, k): the motion of end B less that of end A at the spring, in the spring's axes."""
        signed = [(end, sign) for end, sign in zip(spring.between, (-1.0, 1.0), strict=True) if end != "ground"]
        readings = [(sign, *self._motion(end, spring.interface, spring.placement)) for end, sign in signed]
        rows = np.concatenate([rows for _, rows, _ in readings])
        return rows, np.hstack([sign * motion for sign, _, motion in readings])

    def output(self, description: MachineDescription, configuration: Configuration) -> tuple[IntArray, FloatArray]:
        """Rows and (6, k): the motion of the end-reference point in the axes of the output frame."""
        output = description.file.output
        body, node = output.node.split(".", 1)
        element = self._elements[body]
        position = self._placements[body].act(element.positions[element.node(node)])
        place = pin.SE3(configuration.placement(output.frame).rotation, position)
        return self._motion(output.node, None, place)

    def _motion(self, end: str, interface: str | None, place: pin.SE3) -> tuple[IntArray, FloatArray]:
        body, node = end.split(".", 1)
        element, block = self._elements[body], self._blocks[body]
        nodes = _nodes(element, node, interface)
        motion = sum(self._at_node(element, k, self._placements[body], place) for k in nodes) / len(nodes)
        return np.arange(block.start, block.stop), np.asarray(motion)

    def _at_node(self, element: SuperElement, k: int, body: pin.SE3, place: pin.SE3) -> FloatArray:
        node = body * pin.SE3(np.eye(3), element.positions[k])
        return np.asarray((place.inverse() * node).toActionMatrix() @ element.motions[k])


def _nodes(element: SuperElement, node: str, interface: str | None) -> Sequence[int]:
    """The interface's own node, else the joint's, else all nodes of the joint's interfaces (their mean is taken)."""
    names = element.nodes
    for name in (f"{node}.{interface}", node):
        if name in names:
            return [names.index(name)]
    return [k for k, name in enumerate(names) if name.startswith(f"{node}.")]
