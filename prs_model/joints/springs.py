"""From the joints section to springs: a place, two ends and a JointCompliance for each interface or chain of stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.schema import (
    AXES,
    BallScrew,
    ConstantDrive,
    DiagonalCompliance,
    DiagonalStiffness,
    ElasticLaw,
    Stage,
)
from ..description.urdf import Urdf
from ..kinematics import Placements
from .compliance import (
    JointCompliance,
    along_axes,
    from_stiffness_matrix,
    parallel,
    series,
    series_as_printed,
)
from .drive import drive_compliance

Placement = Callable[[str], pin.SE3 | Placements]


@dataclass(frozen=True, eq=False)
class Spring:
    """What holds end B to end A of a joint at one point, in one configuration or in many.

    `placement` is the spring's frame in the world; `interface` names the one of the joint's interfaces it stands
    for, None for the joint as a whole.
    """

    joint: str
    interface: str | None
    between: tuple[str, str]
    placement: pin.SE3 | Placements
    law: JointCompliance


@dataclass(frozen=True, eq=False)
class Side:
    """One of the things that act side by side in a stage: its place in the stage's frame, and its law."""

    interface: str | None
    place: pin.SE3
    law: JointCompliance


@dataclass(frozen=True, eq=False)
class ElasticStage:
    """A stage whose constant laws are made: the URDF link whose frame it is in, its interfaces, its drive.

    factor: on the stiffness of its drive; that of its interfaces has it already.
    """

    frame: str
    sides: tuple[Side, ...]
    drive: ConstantDrive | BallScrew | None
    driven: str | None
    free: int | None
    factor: float = 1.0

    def at(self, values: Mapping[str, ArrayLike]) -> tuple[Side, ...]:
        """All its sides, the drive's among them, when the URDF joints stand at `values`, () or (N,) [m, rad]."""
        if self.drive is None or self.driven is None or self.free is None:
            return self.sides
        law = along_axes({self.free: drive_compliance(self.drive, values[self.driven])})
        return (*self.sides, Side(None, _place(self.drive.at), law.scaled(self.factor)))

    def scaled(self, factor: float) -> ElasticStage:
        """The stage with `factor` times the stiffness, its drive's included."""
        sides = tuple(replace(side, law=side.law.scaled(factor)) for side in self.sides)
        return replace(self, sides=sides, factor=self.factor * factor)

    def lumped(self, values: Mapping[str, ArrayLike]) -> JointCompliance:
        """All its sides gathered at the origin of its frame (eq. 11, 12)."""
        return self._undriven if self.drive is None else _gathered(self.at(values))

    @cached_property
    def _undriven(self) -> JointCompliance:
        return _gathered(self.sides)


@dataclass(frozen=True, eq=False)
class ElasticJoint:
    """A joint of the engine, made once per machine: one stage, or several in series."""

    name: str
    between: tuple[str, str]
    stages: tuple[ElasticStage, ...]
    in_series: bool
    as_printed: bool

    @property
    def moves(self) -> bool:
        """Whether it has an axis along or about which it moves: bearings do, bolts do not."""
        return any(stage.free is not None for stage in self.stages)

    def scaled(self, factor: float) -> ElasticJoint:
        """The joint with `factor` times the stiffness, its drives' included; what is rigid or free stays so."""
        return replace(self, stages=tuple(stage.scaled(factor) for stage in self.stages))

    def springs(self, values: Mapping[str, ArrayLike], placement: Placement) -> list[Spring]:
        """The springs in one configuration, or in many at once (eq. 9-14).

        Interfaces of a single stage each stay at their own place; so does the drive. Stages in series are gathered
        in the frame of the first one.
        """
        if self.in_series:
            return [self._chain(values, placement)]
        stage = self.stages[0]
        frame = placement(stage.frame)
        return [
            Spring(self.name, side.interface, self.between, frame * side.place, side.law) for side in stage.at(values)
        ]

    def _chain(self, values: Mapping[str, ArrayLike], placement: Placement) -> Spring:
        frames = [placement(stage.frame) for stage in self.stages]
        laws = [stage.lumped(values) for stage in self.stages]
        actions = [_action(frames[0].actInv(frame)) for frame in frames]
        law = series_as_printed(laws, actions) if self.as_printed else series(laws, actions)
        return Spring(self.name, None, self.between, frames[0], law)


def elastic_joints(description: MachineDescription) -> tuple[ElasticJoint, ...]:
    """All joints of a machine, with everything that does not depend on the pose worked out."""
    urdf = description.urdf
    return tuple(
        ElasticJoint(
            name,
            joint.between,
            tuple(_stage(stage, urdf) for stage in joint.stages or (joint,)),
            bool(joint.stages),
            joint.as_printed,
        ).scaled(float(joint.stiffness_factor or 1.0))
        for name, joint in description.joints.items()
    )


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


def _stage(stage: Stage, urdf: Urdf) -> ElasticStage:
    free = free_axis(stage, urdf)
    if stage.interfaces:
        faces = [(face.name, _place(face.at), elastic_law(face, free)) for face in stage.interfaces]
    else:
        faces = [(None, pin.SE3.Identity(), elastic_law(stage, free))]
    sides = tuple(Side(*face) for face in faces)
    frame = urdf.joints[stage.urdf].child if stage.urdf is not None else str(stage.frame)
    return ElasticStage(frame, sides, stage.drive, stage.urdf, free)


def _gathered(sides: Sequence[Side]) -> JointCompliance:
    return parallel([side.law.moved(_action(side.place)) for side in sides])


def _place(at: tuple[float, float, float] | None) -> pin.SE3:
    return pin.SE3.Identity() if at is None else pin.SE3(np.eye(3), np.array(at, dtype=float))


def _action(placement: pin.SE3 | Placements) -> FloatArray:
    return np.asarray(placement.toActionMatrix())
