"""Newton's method on one pose, with the closures as Pinocchio's anchor constraints.

It solves single poses; `newton` solves many at once on our own arrays. Neither uses the other's frames or closure
rows, so that each is a check of the other (but for a structure without joints, where nothing is solved).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from .equations import Equations, Loop, Pair
from .newton import TOLERANCE, least_squares_of_one
from .tree import Link, pinocchio_values

_ITERATIONS = 20


def pinocchio_newton(
    model: pin.Model, equations: Equations, start: FloatArray, target: FloatArray
) -> tuple[FloatArray, bool]:
    """Joint values (n,) from `start` (n,) for one target (t,), and whether they solve the equations."""
    if model.nv == 0:  # nothing to solve, and Pinocchio 4.1 crashes on the Jacobian of such a model
        residual = equations.residual(equations.tree.forward(start[None]), target[None])
        return start.copy(), bool(np.max(np.abs(residual), initial=0.0) <= TOLERANCE)
    data, q = model.createData(), start.copy()
    anchors = [(loop.rows, *_anchor(model, equations, loop)) for loop in equations.loops]
    for _ in range(_ITERATIONS):
        pin.computeJointJacobians(model, data, pinocchio_values(model, q))
        pin.updateFramePlacements(model, data)
        residuals, jacobians = _task_rows(model, data, equations, target)
        for rows, anchor, anchor_data in anchors:
            anchor.calc(model, data, anchor_data)
            residuals.append(np.asarray(anchor_data.constraint_position_error, dtype=float))
            jacobians.append(_error_rate(rows, anchor_data) @ anchor.jacobian(model, data, anchor_data))
        residual = np.concatenate(residuals)
        if np.max(np.abs(residual), initial=0.0) <= TOLERANCE:
            return q, True
        step = least_squares_of_one(np.vstack(jacobians), residual)
        q -= step * min(1.0, 0.5 / max(np.max(np.abs(step)), 0.5))
    return q, False


def _anchor(model: pin.Model, equations: Equations, loop: Loop) -> tuple[Any, Any]:
    a, b = equations.tree.link(loop.pair.a), equations.tree.link(loop.pair.b)
    kind = pin.FrameAnchorConstraintModel if loop.rows == 6 else pin.PointAnchorConstraintModel
    anchor = kind(model, a.carrier, _place(a), b.carrier, _place(b))
    return anchor, anchor.createData()


def _place(link: Link) -> pin.SE3:
    return pin.SE3(link.rotation, link.offset)


def _error_rate(rows: int, data: Any) -> FloatArray:
    """What takes the anchor's Jacobian to the derivative of its error: 1 for points and on the closure.

    Off the closure a frame's error log(M) changes by Jlog6(M) with the velocity seen from the second anchor.
    """
    if rows == 3:
        return np.eye(3)
    return np.asarray(pin.Jlog6(data.c1Mc2) @ data.c1Mc2.toActionMatrixInverse(), dtype=float)


def _task_rows(
    model: pin.Model, data: pin.Data, equations: Equations, target: FloatArray
) -> tuple[list[FloatArray], list[FloatArray]]:
    place, velocity = _seen(model, data, equations.tool)
    R, p, targets = place.rotation[None], place.translation[None], target[None]
    residual = equations.task.residual(R, p, targets)[0]
    return [residual], [equations.task.jacobian(R, p, velocity[None], targets)[0]]


def _seen(model: pin.Model, data: pin.Data, pair: Pair) -> tuple[pin.SE3, FloatArray]:
    """Frame b seen from a, and its velocity (6, n) per joint rate in the axes of a."""
    a, b = (model.getFrameId(name, pin.BODY) for name in (pair.a, pair.b))
    place = data.oMf[a].inverse() * data.oMf[b]
    local = [pin.getFrameJacobian(model, data, frame, pin.LOCAL) for frame in (a, b)]
    twist = local[1] - place.inverse().toActionMatrix() @ local[0]  # of b relative to a, in the axes of b
    return place, np.vstack([place.rotation @ twist[:3], place.rotation @ twist[3:]])
