"""The open tree of a machine as arrays, read once from Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import PrsError
from ..plugins import unknown
from . import kernels


@dataclass(frozen=True)
class Link:
    """A URDF link: the joint frame that carries it (0 = root, j + 1 = joint j) and its place there."""

    carrier: int
    rotation: FloatArray
    offset: FloatArray

    @cached_property
    def on_joint(self) -> bool:
        """Whether it stands in the joint frame itself, as links do that no fixed joint lies between."""
        return not self.offset.any() and np.array_equal(self.rotation, np.eye(3))


@dataclass(frozen=True)
class Frames:
    """Joint frames: rotations (N, n + 1, 3, 3), positions (N, n + 1, 3) [m]; index 0 is the root link."""

    rotations: FloatArray
    positions: FloatArray


@dataclass(frozen=True)
class Tree:
    """Joints with one value each, parents before children; angles in rad, travels in m.

    A continuous joint has one angle here, where Pinocchio keeps its cosine and sine.
    """

    names: tuple[str, ...]
    parents: IntArray  # (n,) frame index of the parent
    rotations: FloatArray  # (n, 3, 3) fixed placement in the parent frame
    offsets: FloatArray  # (n, 3)
    axes: FloatArray  # (n, 3) in the joint frame
    revolute: BoolArray  # (n,)
    lower: FloatArray  # (n,) minus infinity for continuous joints
    upper: FloatArray
    links: Mapping[str, Link]
    ancestry: BoolArray  # (n + 1, n): joint moves frame

    @property
    def size(self) -> int:
        """Number of joint values n."""
        return len(self.names)

    @property
    def middle(self) -> FloatArray:
        """Joint values (n,) half-way between their limits [m, rad], zero where a side has none."""
        limited = np.isfinite(self.lower) & np.isfinite(self.upper)
        return np.asarray((np.where(limited, self.lower, 0.0) + np.where(limited, self.upper, 0.0)) / 2.0)

    def joint(self, name: str) -> int:
        """Position of a joint in q. Raises UnknownNameError."""
        if name not in self.names:
            raise unknown("joint", name, list(self.names))
        return self.names.index(name)

    def link(self, name: str) -> Link:
        """A link by name. Raises UnknownNameError."""
        if name not in self.links:
            raise unknown("link", name, list(self.links))
        return self.links[name]

    def forward(self, q: FloatArray) -> Frames:
        """All joint frames at q (N, n)."""
        return Frames(*kernels.forward(q, self.parents, self.rotations, self.offsets, self.axes, self.revolute))

    def link_frame(self, frames: Frames, name: str) -> tuple[FloatArray, FloatArray]:
        """Rotation (N, 3, 3) and position (N, 3) of a link."""
        link = self.link(name)
        R, p = frames.rotations[:, link.carrier], frames.positions[:, link.carrier]
        return (R, p) if link.on_joint else (R @ link.rotation, p + R @ link.offset)

    def placements(self, frames: Frames, name: str) -> FloatArray:
        """Homogeneous placements (N, 4, 4) of a link, seen from the root link."""
        placements = np.zeros((len(frames.positions), 4, 4))
        placements[:, :3, :3], placements[:, :3, 3] = self.link_frame(frames, name)
        placements[:, 3, 3] = 1.0
        return placements


def read_tree(model: pin.Model) -> Tree:
    """Read a Pinocchio model of revolute, continuous and prismatic joints. Raises PrsError for any other."""
    joints = range(1, model.njoints)
    screws = np.array([_screw(model, joint) for joint in joints]).reshape(-1, 6)
    revolute = np.any(screws[:, 3:], axis=1)
    parents = np.array([model.parents[joint] for joint in joints], dtype=np.intp)
    placements = [model.jointPlacements[joint] for joint in joints]
    limits = np.array([_limits(model, joint) for joint in joints]).reshape(-1, 2)
    return Tree(
        names=tuple(model.names[joint] for joint in joints),
        parents=parents,
        rotations=np.array([placement.rotation for placement in placements]).reshape(-1, 3, 3),
        offsets=np.array([placement.translation for placement in placements]).reshape(-1, 3),
        axes=np.where(revolute[:, None], screws[:, 3:], screws[:, :3]),
        revolute=revolute,
        lower=limits[:, 0],
        upper=limits[:, 1],
        links={
            frame.name: Link(frame.parentJoint, frame.placement.rotation, frame.placement.translation)
            for frame in model.frames
            if frame.type == pin.BODY
        },
        ancestry=_ancestry(parents),
    )


def pinocchio_values(model: pin.Model, q: FloatArray) -> FloatArray:
    """q (n,) as Pinocchio wants it, with cosine and sine for continuous joints."""
    parts = [[value] if model.joints[j + 1].nq == 1 else [np.cos(value), np.sin(value)] for j, value in enumerate(q)]
    return np.array([number for part in parts for number in part])


def _screw(model: pin.Model, joint: int) -> FloatArray:
    """The motion subspace (6,) of a joint with one degree of freedom."""
    kind = model.joints[joint]
    if kind.nv != 1:
        raise PrsError(
            f"joint {model.names[joint]}: found {kind.nv} degrees of freedom, expected one; "
            "write it as several revolute or prismatic joints with massless links between"
        )
    data = kind.createData()
    kind.calc(data, np.array([1.0, 0.0])[: kind.nq])
    return np.asarray(data.S, dtype=float).ravel()


def _limits(model: pin.Model, joint: int) -> tuple[float, float]:
    kind = model.joints[joint]
    if kind.nq == 2:
        return -np.inf, np.inf
    return float(model.lowerPositionLimit[kind.idx_q]), float(model.upperPositionLimit[kind.idx_q])


def _ancestry(parents: IntArray) -> BoolArray:
    table = np.zeros((len(parents) + 1, len(parents)), dtype=bool)
    for j, parent in enumerate(parents):
        table[j + 1] = table[parent]
        table[j + 1, j] = True
    return table
