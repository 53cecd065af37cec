"""Whether nodes are close enough for the joints' values, from which all else follows: tried at very many poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray
from ...kinematics import Kinematics
from ..not_smooth import NotSmoothError
from ..poses import Poses
from .spectral import Box
from .tensor import Tensor

_MANY = 1000
_SHARE = 0.01  # of its range, by which a joint may be off
_LEAST = 1e-9  # m, rad


@dataclass(frozen=True, eq=False)
class JointValues:
    """Reachable poses spread over those of a sweep, and the joints' values there (m, j) [m, rad]."""

    poses: Poses
    values: FloatArray

    def are_met_by(self, box: Box, at_nodes: FloatArray) -> bool:
        """Whether interpolation from the values at the solved nodes of a box (s, j) meets them."""
        interpolated = Tensor(box, box.unfold(at_nodes), 0.0).reader(self.poses)(0, self.poses.size).T
        ranges = np.ptp(np.concatenate([self.values, at_nodes]), axis=0)
        return bool(np.all(np.abs(interpolated - self.values) <= _SHARE * ranges + _LEAST))


def joint_values(kinematics: Kinematics, poses: Poses) -> JointValues:
    """At a thousand of the poses. Raises NotSmoothError where none of them is within reach."""
    some = poses.at(np.unique(np.linspace(0, poses.size - 1, _MANY).astype(np.intp)))
    found = kinematics.solve_batch(some)
    there = found.reachable
    if not there.any():
        raise NotSmoothError("none of the poses that were tried is within reach")
    return JointValues(Poses(poses.names, (), some[there]), found.q[there])
