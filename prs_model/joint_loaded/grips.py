"""How joints take hold of one part, and how what is on their other side moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from ..arrays import FloatArray
from ..joints import ElasticJoint, Spring
from ..kinematics import Configuration
from ..synthesis.ends import Ends


@dataclass(frozen=True, eq=False)
class Grip:
    """The springs of a joint that meet one motion beyond it, at one end of them.

    end: (m, n), the motions of the part that the springs' wrenches work on, from its coordinates. beyond: (m, 6), those
    of the other ends when the body beyond, or the ground, moves by a unit twist at this part's origin, in its axes.
    other: (m, k), the same from that body's coordinates, `body`; empty and None for the ground. compliance: (m, m).
    nodes: of the part, that they take hold of. several: whether the body beyond can deform between them.
    """

    end: FloatArray
    beyond: FloatArray
    other: FloatArray
    body: str | None
    compliance: FloatArray
    nodes: tuple[int, ...]
    several: bool


def grips(body: str, joints: Sequence[ElasticJoint], ends: Ends, at: Configuration, laws: Configuration) -> list[Grip]:
    """Every hold of joints on a body: springs placed as in the configuration `at`, as stiff as in `laws`.

    What is bolted or rigid follows the other side at each interface; bearings and carriages meet it as one body.
    """
    held: dict[tuple[str, int, bool, str | None], list[Spring]] = {}
    for joint in joints:
        sides = [side for side in (0, 1) if _body(joint.between[side]) == body]
        for spring in joint.springs(laws.joint_values, at.placement) if sides else ():
            apart = not joint.moves or spring.law.rigid_wrenches.shape[1] > 0
            for side in sides:
                held.setdefault((joint.name, side, apart, spring.interface if apart else None), []).append(spring)
    return [_grip(springs, side, ends) for (_, side, *_), springs in held.items()]


def _grip(springs: Sequence[Spring], side: int, ends: Ends) -> Grip:
    end, beyond = springs[0].between[side], springs[0].between[1 - side]
    grounded = beyond == "ground"
    end_motions = _motions(springs, end, ends)
    placement = ends.placements[_body(end)]
    twists = [spring.law.wrenches.T @ spring.placement.actInv(placement).toActionMatrix() for spring in springs]
    return Grip(
        end=end_motions,
        beyond=np.vstack(twists),
        other=np.zeros((len(end_motions), 0)) if grounded else _motions(springs, beyond, ends),
        body=None if grounded else _body(beyond),
        compliance=block_diag(*(spring.law.compliance for spring in springs)),
        nodes=tuple(node for spring in springs for node in ends.nodes(end, spring.interface)),
        several=len(springs) > 1,
    )


def _motions(springs: Sequence[Spring], end: str, ends: Ends) -> FloatArray:
    """(m, n): what the springs' wrenches work on at one end, from the coordinates of its body."""
    seen = [ends.motion(end, spring.interface, spring.placement)[1] for spring in springs]
    return np.vstack([spring.law.wrenches.T @ motion for spring, motion in zip(springs, seen, strict=True)])


def _body(end: str) -> str:
    return end.split(".", 1)[0]
