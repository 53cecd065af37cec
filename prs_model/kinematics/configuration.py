"""Where a machine stands: one configuration, or many at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pinocchio as pin

from ..arrays import BoolArray, FloatArray
from ..errors import UnreachablePoseError
from .placements import Placements
from .tree import Frames, Tree


@dataclass(frozen=True, eq=False)
class Configuration:
    """One configuration: pose [m, rad] and joint values q (n,) [m, rad], in the order of `joint_values`.

    `closure_residual` is the largest gap [m] or angle [rad] by which the loops stay open.
    """

    pose: Mapping[str, float]
    q: FloatArray
    closure_residual: float
    tree: Tree

    @property
    def joint_values(self) -> Mapping[str, float]:
        """Value of every URDF joint that moves [m, rad]."""
        return dict(zip(self.tree.names, self.q.tolist(), strict=True))

    def placement(self, frame: str) -> pin.SE3:
        """Placement of a URDF link, seen from the root link [m]. Raises UnknownNameError."""
        return pin.SE3(self.tree.placements(self._frames, frame)[0])

    def moved(self, joint_values: Mapping[str, float]) -> Configuration:
        """The same with some joints [m, rad] elsewhere, loops open as they may be."""
        q = np.array([{**self.joint_values, **joint_values}[name] for name in self.tree.names])
        return replace(self, q=q, closure_residual=float("inf"))

    @cached_property
    def _frames(self) -> Frames:
        return self.tree.forward(self.q[None])


@dataclass(frozen=True, eq=False)
class Configurations:
    """Configurations at poses (N, d) [m, rad], in the order given.

    Poses beyond a joint limit keep their joint values; poses that no configuration reaches have NaN for them and an
    infinite residual. Both are marked in `reachable` and explained in `reasons`; `self[i]` raises their error.
    """

    pose_names: tuple[str, ...]
    poses: FloatArray
    q: FloatArray
    closure_residual: FloatArray
    errors: Mapping[int, UnreachablePoseError]
    tree: Tree

    def __len__(self) -> int:
        return len(self.poses)

    def __getitem__(self, i: int) -> Configuration:
        i = range(len(self))[i]
        if i in self.errors:
            raise self.errors[i]
        pose = dict(zip(self.pose_names, self.poses[i].tolist(), strict=True))
        return Configuration(pose, self.q[i], float(self.closure_residual[i]), self.tree)

    @cached_property
    def reachable(self) -> BoolArray:
        """Whether a pose is reached within the joint limits (N,)."""
        reachable = np.ones(len(self), dtype=bool)
        reachable[list(self.errors)] = False
        return reachable

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why a pose is not reachable, empty where it is (N,)."""
        return tuple(str(self.errors.get(i, "")) for i in range(len(self)))

    @property
    def joint_values(self) -> Mapping[str, FloatArray]:
        """Values (N,) of every URDF joint that moves [m, rad]."""
        return dict(zip(self.tree.names, self.q.T, strict=True))

    def placement(self, frame: str) -> Placements:
        """Placements of a URDF link, seen from the root link [m]. Raises UnknownNameError."""
        link = self.tree.link(frame)
        rotation, translation = self.tree.link_frame(self._frames, frame)
        return Placements(rotation, translation, link.carrier, pin.SE3(link.rotation, link.offset))

    def placements(self, frame: str) -> FloatArray:
        """Placements (N, 4, 4) of a URDF link, seen from the root link [m]. Raises UnknownNameError."""
        return self.tree.placements(self._frames, frame)

    @cached_property
    def _frames(self) -> Frames:
        return self.tree.forward(self.q)
