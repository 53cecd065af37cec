"""From the joints section to springs: a place, two ends and a JointCompliance for each interface or chain of stages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..description.schema import (
    AXES,
    DiagonalCompliance,
    DiagonalStiffness,
    ElasticLaw,
    Joint,
    Stage,
)
from ..description.urdf import Urdf
from .compliance import (
    JointCompliance,
    along_axes,
    from_stiffness_matrix,
    parallel,
    series,
    series_as_printed,
)
from .drive import drive_compliance

Placement = Callable[[str], pin.SE3]


@dataclass(frozen=True)
class Spring:
    """What holds end B to end A of a joint at one point.

    `placement` is the spring's frame in the world; `interface` names the one of the joint's interfaces it stands
    for, None for the joint as a whole.
    """

    joint: str
    interface: str | None
    between: tuple[str, str]
    placement: pin.SE3
    law: JointCompliance


def springs(name: str, joint: Joint, urdf: Urdf, values: dict[str, float], placement: Placement) -> list[Spring]:
    """The springs of one joint in one configuration (eq. 9-14).

    Interfaces of a single stage each stay at their own place; so does the drive. Stages in series are gathered
    in the frame of the first one.
    """
    if joint.stages:
        return [_stages_in_series(name, joint, urdf, values, placement)]
    frame = placement(_frame(joint, urdf))
    free = free_axis(joint, urdf)
    return [
        Spring(name, interface, joint.between, frame * pin.SE3(np.eye(3), at), law)
        for interface, at, law in _in_parallel(joint, free, values)
    ]


def free_axis(stage: Stage, urdf: Urdf) -> int | None:
    """The axis 0..5 of the stage's frame along or about which its URDF joint moves; None for a fixed one."""
    if stage.urdf is None:
        return None
    name = urdf.joints[stage.urdf].free_axis
    return None if name is None else AXES.index(name)


def elastic_law(law: ElasticLaw, free: int | None) -> JointCompliance:
    """The compliance of one interface on the wrenches it constrains, in its own frame."""
    constrained = [axis for axis in range(6) if axis != free]
    if law.rigid:
        return along_axes(dict.fromkeys(constrained, 0.0))
    if isinstance(law.stiffness, DiagonalStiffness):
        stiffness = {axis: float(getattr(law.stiffness, AXES[axis])) for axis in constrained}
        return along_axes({axis: 1.0 / k for axis, k in stiffness.items() if k > 0.0})
    if isinstance(law.compliance, DiagonalCompliance):
        return along_axes({axis: float(getattr(law.compliance, AXES[axis])) for axis in constrained})
    if law.stiffness is not None:
        return from_stiffness_matrix(np.array(law.stiffness, dtype=float))
    compliance = np.array(law.compliance, dtype=float)
    return JointCompliance(np.eye(6)[:, constrained], compliance[np.ix_(constrained, constrained)])


def _in_parallel(
    stage: Stage, free: int | None, values: dict[str, float]
) -> list[tuple[str | None, FloatArray, JointCompliance]]:
    """Name, place and law of everything that acts side by side in a stage, in axes of the stage's frame."""
    origin = np.zeros(3)
    if stage.interfaces:
        sides = [
            (face.name, origin if face.at is None else np.array(face.at, dtype=float), elastic_law(face, free))
            for face in stage.interfaces
        ]
    else:
        sides = [(None, origin, elastic_law(stage, free))]
    if stage.drive is not None and stage.urdf is not None and free is not None:
        at = origin if stage.drive.at is None else np.array(stage.drive.at, dtype=float)
        sides.append((None, at, along_axes({free: drive_compliance(stage.drive, values[stage.urdf])})))
    return sides


def _stages_in_series(name: str, joint: Joint, urdf: Urdf, values: dict[str, float], placement: Placement) -> Spring:
    frames = [placement(_frame(stage, urdf)) for stage in joint.stages]
    laws = [_lumped(stage, free_axis(stage, urdf), values) for stage in joint.stages]
    actions = [np.asarray((frames[0].inverse() * frame).toActionMatrix()) for frame in frames]
    if joint.as_printed:
        law = series_as_printed(laws, actions)
    else:
        law = series([stage.moved(action) for stage, action in zip(laws, actions, strict=True)])
    return Spring(name, None, joint.between, frames[0], law)


def _lumped(stage: Stage, free: int | None, values: dict[str, float]) -> JointCompliance:
    """All of a stage's interfaces and its drive, gathered at the origin of its frame (eq. 11, 12)."""
    gathered = [
        law.moved(np.asarray(pin.SE3(np.eye(3), at).toActionMatrix()))
        for _, at, law in _in_parallel(stage, free, values)
    ]
    return parallel(gathered)


def _frame(stage: Stage, urdf: Urdf) -> str:
    """The URDF link whose frame the stage's axes are: the child link of its joint, or the frame it names."""
    return urdf.joints[stage.urdf].child if stage.urdf is not None else str(stage.frame)
