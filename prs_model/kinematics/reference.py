"""The stored reference configuration: checked, then corrected to the last digit."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.problems import Place
from .equations import Equations
from .newton import TOLERANCE, least_squares_of_one
from .reach import Reach

_RANK_TOLERANCE = 1e-5  # relative; what is smaller is a redundant row of a closure written with few digits
_LARGEST_CORRECTION = 1e-3  # of a stored joint value [m, rad]
_ITERATIONS = 30
_HERE: Place = ("task", "reference")
_Problem = tuple[Place, str]


def reference_configuration(description: MachineDescription, equations: Equations, reach: Reach) -> FloatArray:
    """Joint values (n,) at which the machine's loops close in its reference pose.

    Raises DescriptionError naming the entry ``task.reference`` when the stored joint values do not give the reference
    pose within 1 mm or 1 mrad, when a joint is beyond its limits, or when the task does not fit the mechanism.
    """
    pose = np.array(list(description.reference_pose.values()))
    stored = np.array([description.reference_joints[name] for name in equations.tree.names])
    target = equations.task.targets(pose[None])
    q = _corrected(equations, stored, target)
    problem = (
        _never_moves(equations)
        or _not_closed(equations, stored, q, target)
        or _too_far(reach, stored, q)
        or _beyond_limits(reach, pose, q)
        or _wrong_mobility(equations, q, target)
    )
    if problem is not None:
        raise description.problem(*problem)
    return q


def _corrected(equations: Equations, q: FloatArray, target: FloatArray) -> FloatArray:
    """Gauss-Newton from the stored values, along the directions that the equations determine."""
    for _ in range(_ITERATIONS if len(q) else 0):
        frames = equations.tree.forward(q[None])
        residual = equations.residual(frames, target)[0]
        if np.max(np.abs(residual), initial=0.0) <= TOLERANCE:
            break
        step = least_squares_of_one(equations.jacobian(frames, target)[0], residual, _RANK_TOLERANCE)
        q = q - step * min(1.0, 0.5 / max(np.max(np.abs(step)), 0.5))
    return q


def _never_moves(equations: Equations) -> _Problem | None:
    tool = equations.tool
    if tool.moves.any() or not equations.task.coordinates:
        return None
    message = f"found '{tool.b}', which no joint moves relative to '{tool.a}'; expected the link that the task moves"
    return ("task", "frame"), message


def _not_closed(equations: Equations, stored: FloatArray, q: FloatArray, target: FloatArray) -> _Problem | None:
    gap = float(np.max(np.abs(equations.residual(equations.tree.forward(q[None]), target)), initial=0.0))
    if gap <= TOLERANCE:
        return None
    if gap < _LARGEST_CORRECTION:
        return _HERE, (
            f"found a fit to {gap:.2g} m or rad at best ({_gaps(equations, q, target)}), expected {TOLERANCE:g}; write "
            "the URDF's origins and axes with all digits, or close a redundant loop by 'point'"
        )
    if not len(q):
        return ("closures",), (
            f"found links that do not meet, and no joint that moves ({_gaps(equations, q, target)}), expected links "
            "that coincide; correct the closures or the URDF's origins"
        )
    return _HERE, (
        f"found joint values near which nothing closes the loops in the reference pose (as stored: "
        f"{_gaps(equations, stored, target)}), expected the joint values of that pose; correct them, the pose, the "
        "task's frames, the closures or the URDF"
    )


def _gaps(equations: Equations, q: FloatArray, target: FloatArray) -> str:
    """What joint values (n,) leave open, loop by loop and for the pose, in words."""
    ends = np.cumsum([loop.rows for loop in equations.loops], dtype=int)
    rows = np.split(np.abs(equations.residual(equations.tree.forward(q[None]), target)[0]), ends)
    gaps = [f"{loop.name} open by {row.max():.3g}" for loop, row in zip(equations.loops, rows, strict=False)]
    if equations.task.coordinates:
        gaps.append(f"the pose missed by {rows[-1].max():.3g}")
    return ", ".join(gaps) + " m or rad"


def _too_far(reach: Reach, stored: FloatArray, q: FloatArray) -> _Problem | None:
    if not len(q):
        return None
    j = int(np.argmax(np.abs(q - stored)))
    if abs(q[j] - stored[j]) <= _LARGEST_CORRECTION:
        return None
    found, needed = reach.joint_text(j, stored[j]), reach.joint_text(j, q[j])
    name = reach.tree.names[j]
    return (*_HERE, "joints", name), (
        f"found {found} for {name}, expected {needed} in the reference pose; correct the joint values, the pose or "
        "the task's frames"
    )


def _beyond_limits(reach: Reach, pose: FloatArray, q: FloatArray) -> _Problem | None:
    error = reach.beyond_limits(pose, q)
    return None if error is None else (_HERE, f"{error}; correct the reference or the limits in the URDF")


def _wrong_mobility(equations: Equations, q: FloatArray, target: FloatArray) -> _Problem | None:
    """Degrees of freedom n - rank(closures) against the task's coordinates, by rank and not by counting rows."""
    jacobian = equations.jacobian(equations.tree.forward(q[None]), target)[0]
    joints, coordinates = equations.tree.size, len(equations.task.coordinates)
    rank, kind = _rank(jacobian[: equations.loop_rows]), equations.task.section.kind
    if joints - rank != coordinates:
        return ("task", "kind"), (
            f"found {coordinates} coordinates in task '{kind}', expected {joints - rank}, the degrees of freedom of "
            f"the mechanism ({joints} joints less closures of rank {rank}); choose another task, or correct the "
            "closures"
        )
    lost = joints - _rank(jacobian)
    if lost:
        return _HERE, (
            f"found a singular configuration: the pose of task '{kind}' leaves {lost} of the mechanism's "
            f"{coordinates} degrees of freedom undetermined; choose another reference, or another task"
        )
    return None


def _rank(matrix: FloatArray) -> int:
    return int(np.linalg.matrix_rank(matrix, rtol=_RANK_TOLERANCE)) if matrix.size else 0
