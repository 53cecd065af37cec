"""Reading the motion of joint ends and of the output point from the bodies' coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..description.schema import Output
from ..errors import UnknownNameError
from ..joints import Spring
from ..kinematics import Placements
from ..reduction import Elements, SuperElement

Placement: TypeAlias = pin.SE3 | Placements


@dataclass(frozen=True, eq=False)
class RelativeDisplacement:
    """Motion of end B less that of end A in the spring's axes, on the coordinates of the bodies that have these ends.

    blocks: the bodies' rows, in ascending order; ends: for each the motions (6, n_b) of the ends it has, signed.
    """

    blocks: tuple[slice, ...]
    ends: tuple[tuple[FloatArray, ...], ...]

    @property
    def motions(self) -> tuple[FloatArray, ...]:
        """(6, n_b) for each block."""
        return tuple(ends[0] if len(ends) == 1 else ends[0] + ends[1] for ends in self.ends)

    @property
    def sizes(self) -> tuple[FloatArray, ...]:
        """Sums of the two motions' magnitudes: entries of `motions` far below them are round-off."""
        return tuple(np.sum([np.abs(end) for end in ends], axis=0) for ends in self.ends)


@dataclass(frozen=True, eq=False)
class Ends:
    """The bodies of a machine in one configuration: elements, rows among all coordinates, placements in the world.

    Or in N at once, with stacks for elements and placements; the motions are then (N, 6, k), or (1, 6, k) where they
    are the same in all.
    """

    elements: Mapping[str, SuperElement] | Mapping[str, Elements]
    blocks: Mapping[str, slice]
    placements: Mapping[str, Placement]

    def relative_displacement(self, spring: Spring) -> RelativeDisplacement:
        """What the spring feels; both ends may be on one body, one may be the ground."""
        found: dict[str, list[FloatArray]] = {}
        for end, sign in zip(spring.between, (-1.0, 1.0), strict=True):
            if end != "ground":
                _, motion = self.motion(end, spring.interface, spring.placement)
                found.setdefault(end.split(".", 1)[0], []).append(sign * motion)
        bodies = sorted(found, key=lambda body: self.blocks[body].start)
        return RelativeDisplacement(
            tuple(self.blocks[body] for body in bodies), tuple(tuple(found[body]) for body in bodies)
        )

    def gap(self, springs: Sequence[Spring]) -> float:
        """Distance [m] between the nodes at which the ends of a joint's springs are read; the ground's is their place.

        The largest of all springs; where one end has fewer nodes than the other, that between the means of the nodes.
        """
        (here, nodes), (there, others) = (self._places(springs, side) for side in (0, 1))
        apart = here - there if nodes == others else np.mean(here - there, axis=0, keepdims=True)
        return float(np.linalg.norm(apart, axis=1).max())

    def _places(self, springs: Sequence[Spring], side: int) -> tuple[FloatArray, int]:
        """Where one end of each spring is read (s, 3) [m], and at how many different nodes, or sets of them."""
        ends = [(spring.between[side], spring.interface) for spring in springs]
        if ends[0][0] == "ground":
            return np.array([spring.placement.translation for spring in springs]), len(set(ends))
        places = np.array([self.position(end, interface) for end, interface in ends])
        return places, len({tuple(self.nodes(end, interface)) for end, interface in ends})

    def position(self, end: str, interface: str | None = None) -> FloatArray:
        """Where the node stands at which an end is read (3,) [m], in the world."""
        body = end.split(".", 1)[0]
        element = self.elements[body]
        middle = np.mean([element.positions[..., k, :] for k in self.nodes(end, interface)], axis=0)
        return np.asarray(self.placements[body].act(middle))

    def output(self, output: Output, frame: Placement) -> tuple[Placement, IntArray, FloatArray]:
        """Where the end-reference point stands, with the axes of the output frame; rows (k,) and its motion (6, k)."""
        place = type(frame)(frame.rotation, self.position(output.node))
        return place, *self.motion(output.node, None, place)

    def motion(self, end: str, interface: str | None, place: Placement) -> tuple[IntArray, FloatArray]:
        """Coordinates (k,) of an end's body, and the end's motion (6, k) on them as seen at `place`, in its axes."""
        body = end.split(".", 1)[0]
        element, block = self.elements[body], self.blocks[body]
        nodes = self.nodes(end, interface)
        of_origin = sum(element.motions_of_origin[..., k, :, :] for k in nodes) / len(nodes)
        motion = place.actInv(self.placements[body]).toActionMatrix() @ of_origin
        return np.arange(block.start, block.stop), np.asarray(motion)

    def nodes(self, end: str, interface: str | None) -> Sequence[int]:
        """The interface's own node, else the joint's, else all of the joint's interfaces (their mean is taken).

        Nodes at stations (``rail.left@2``) are none of them: the travelling node stands among these under its own name.
        """
        body, node = end.split(".", 1)
        names = self.elements[body].nodes
        for name in (f"{node}.{interface}", node):
            if name in names:
                return [names.index(name)]
        found = [k for k, name in enumerate(names) if name.startswith(f"{node}.") and "@" not in name]
        if not found:
            raise UnknownNameError(f"node of {self.elements[body].name}", node, names)
        return found
