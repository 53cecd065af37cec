"""How joints take hold of one part, and how what is on their other side moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..joints import ElasticJoint, JointCompliance, Spring
from ..kinematics import Configuration
from ..reduction import SuperElement
from ..synthesis.ends import Ends


@dataclass(frozen=True, eq=False)
class Grip:
    """One end of a spring.

    end: (6, n), the motion of the part's end on its coordinates, in the spring's axes. counterpart: (6, 6), that of the
    other end when the body beyond moves rigidly, by a unit twist at this part's origin in its axes; zero for the
    ground. pattern: grips of one pattern meet the same rigid motion. nodes: of the part, that it takes hold of.
    """

    end: FloatArray
    counterpart: FloatArray
    law: JointCompliance
    pattern: tuple[str, str | None]
    nodes: tuple[int, ...]


def grips(
    body: str, element: SuperElement, joints: Sequence[ElasticJoint], at: Configuration, frame: str, laws: Configuration
) -> list[Grip]:
    """Every hold of joints on a body with this element and frame; springs as `laws` has them, placed as in `at`."""
    placement = at.placement(frame)
    ends = Ends({body: element}, {body: slice(0, element.size)}, {body: placement})
    return [
        _grip(joint, spring, side, ends, placement)
        for joint in joints
        if body in {_body(end) for end in joint.between}
        for spring in joint.springs(laws.joint_values, at.placement)
        for side in (0, 1)
        if _body(spring.between[side]) == body
    ]


def _grip(joint: ElasticJoint, spring: Spring, side: int, ends: Ends, placement: pin.SE3) -> Grip:
    end, beyond = spring.between[side], spring.between[1 - side]
    seen = np.asarray((spring.placement.inverse() * placement).toActionMatrix())
    return Grip(
        end=ends.motion(end, spring.interface, spring.placement)[1],
        counterpart=np.zeros((6, 6)) if beyond == "ground" else seen,
        law=spring.law,
        pattern=(joint.name, spring.interface if _follows_each_interface(joint, spring) else None),
        nodes=tuple(ends.nodes(end, spring.interface)),
    )


def _follows_each_interface(joint: ElasticJoint, spring: Spring) -> bool:
    """What is bolted or rigid follows the other side's deformation; bearings and carriages meet it as a rigid body."""
    return not joint.moves or spring.law.rigid_wrenches.shape[1] > 0


def _body(end: str) -> str:
    return end.split(".", 1)[0]
