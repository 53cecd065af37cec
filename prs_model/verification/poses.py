"""The poses of a verification: stated by the machine, the bounds of its workspace, a grid, or random ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np

from ..errors import PrsError
from ..machine import Machine

Pose = dict[str, float]
_TRIES = 100


def default_poses(machine: Machine) -> tuple[Pose, ...]:
    """The reference pose, then those of the machine's `verification` section.

    Without that section: every coordinate at its bounds of the workspace, the others at their reference.
    """
    reference = dict(machine.reference_pose)
    stated = machine.description.verification_poses
    if stated:
        return distinct([reference, *grid_poses(machine, stated)])
    bounds = [reference | {name: bound} for name, pair in machine.workspace.items() for bound in pair]
    return distinct([reference, *bounds])


def grid_poses(machine: Machine, values: Mapping[str, Sequence[float]]) -> tuple[Pose, ...]:
    """Every combination of these values [m, rad], the last coordinate running fastest; others at their reference.

    Raises UnknownNameError for a coordinate that the task does not have.
    """
    for name in values:
        if name not in machine.pose_names:
            from ..plugins import unknown

            raise unknown("pose coordinate", name, list(machine.pose_names))
    points = product(*values.values())
    return tuple(dict(machine.reference_pose) | dict(zip(values, point, strict=True)) for point in points)


def random_poses(machine: Machine, count: int, seed: int = 0) -> tuple[Pose, ...]:
    """Poses spread evenly over the workspace [m, rad], the same for the same seed; unreachable ones are drawn again.

    Raises PrsError when hardly any pose of the stated workspace is reachable.
    """
    names = machine.pose_names
    low, high = np.array([machine.workspace[name] for name in names]).reshape(-1, 2).T
    draw = np.random.default_rng(seed)
    poses: list[Pose] = []
    for _ in range(_TRIES):
        points = draw.uniform(low, high, (count, len(names)))
        reached = points[machine.kinematics.solve_batch(points).reachable]
        poses += [dict(zip(names, point.tolist(), strict=True)) for point in reached]
        if len(poses) >= count:
            return tuple(poses[:count])
    raise PrsError(
        f"only {len(poses)} of {_TRIES * count} random poses of the stated workspace are reachable, expected {count}; "
        "correct task.workspace"
    )


def distinct(poses: Sequence[Pose]) -> tuple[Pose, ...]:
    """The poses in order, each once."""
    return tuple(dict(items) for items in dict.fromkeys(tuple(pose.items()) for pose in poses))
