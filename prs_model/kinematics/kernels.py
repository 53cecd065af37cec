"""Batched rigid-body kinematics on plain arrays: no checks, pose axis first, SI units.

A batch of frames is a pair: rotations (N, ..., 3, 3) and positions (N, ..., 3), both seen from the root link.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.integer[Any]]
BoolArray = NDArray[np.bool_]

_SMALL_ANGLE = 1e-4


def skew(v: FloatArray) -> FloatArray:
    """[v]x (..., 3, 3) with [v]x w = v x w."""
    matrix = np.zeros((*v.shape, 3))
    matrix[..., 0, 1], matrix[..., 0, 2], matrix[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    matrix[..., 1, 0], matrix[..., 2, 0], matrix[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return matrix


def rotation(vector: FloatArray) -> FloatArray:
    """exp([v]x) (..., 3, 3) of rotation vectors (..., 3), by Rodrigues' formula."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    small = angle < _SMALL_ANGLE
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 1.0 - angle**2 / 6.0, np.sin(safe) / safe)
    second = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    cross = skew(vector)
    return np.asarray(np.eye(3) + first * cross + second * (cross @ cross))


def rotation_vector(R: FloatArray) -> FloatArray:
    """The rotation vector (..., 3) of R (..., 3, 3), of length 0 .. pi; accurate at both ends.

    4 q q^T is linear in R; its row with the largest diagonal gives the quaternion q without cancellation.
    """
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    wx, wy, wz = R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]
    xy, xz, yz = R[..., 0, 1] + R[..., 1, 0], R[..., 0, 2] + R[..., 2, 0], R[..., 1, 2] + R[..., 2, 1]
    rows = [
        [1 + xx + yy + zz, wx, wy, wz],
        [wx, 1 + xx - yy - zz, xy, xz],
        [wy, xy, 1 - xx + yy - zz, yz],
        [wz, xz, yz, 1 - xx - yy + zz],
    ]
    outer = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(outer, largest[..., None, None], axis=-2)[..., 0, :]
    q = q / (np.linalg.norm(q, axis=-1, keepdims=True) * np.where(q[..., :1] < 0, -1.0, 1.0))
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    small = sine < _SMALL_ANGLE
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    return np.asarray(q[..., 1:] * np.where(small, 2.0 + sine**2 / 3.0, angle / np.where(small, 1.0, sine)))


def inverse_left_jacobian(vector: FloatArray) -> FloatArray:
    """J (..., 3, 3) with d(rotation vector)/dt = J omega, omega in the axes that R maps to.

    J = 1 - [v]x / 2 + (1 - (a/2) cot(a/2)) / a^2 [v]x^2, a = |v|.
    """
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    small = angle < _SMALL_ANGLE
    safe = np.where(small, 1.0, angle)
    factor = np.where(small, 1 / 12 + angle**2 / 720, (1.0 - 0.5 * safe / np.tan(0.5 * safe)) / safe**2)
    cross = skew(vector)
    return np.asarray(np.eye(3) - 0.5 * cross + factor * (cross @ cross))


def forward(
    q: FloatArray,
    parents: IntArray,
    rotations: FloatArray,
    offsets: FloatArray,
    axes: FloatArray,
    revolute: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Frames of the root (index 0) and of every joint's child (index 1 + joint), (N, n + 1).

    q (N, n); joint j stands at rotations[j], offsets[j] in frame parents[j] <= j and moves about or along axes[j].
    """
    count, n = q.shape
    R, p = np.empty((count, n + 1, 3, 3)), np.empty((count, n + 1, 3))
    R[:, 0], p[:, 0] = np.eye(3), 0.0
    cross = skew(axes)
    for j in range(n):
        R_parent, fixed = R[:, parents[j]], rotations[j]
        if revolute[j]:
            sine, versine = np.sin(q[:, j, None, None]), 1.0 - np.cos(q[:, j, None, None])
            local = fixed + sine * (fixed @ cross[j]) + versine * (fixed @ cross[j] @ cross[j])
            offset = np.broadcast_to(offsets[j], (count, 3))
        else:
            local, offset = fixed, offsets[j] + q[:, j, None] * (fixed @ axes[j])
        R[:, j + 1] = R_parent @ local
        p[:, j + 1] = p[:, parents[j]] + transform(R_parent, offset)
    return R, p


def transform(R: FloatArray, v: FloatArray) -> FloatArray:
    """R v for R (..., 3, 3) and v (..., 3)."""
    return (R @ v[..., None])[..., 0]


def relative_frame(R_a: FloatArray, p_a: FloatArray, R_b: FloatArray, p_b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frame b seen from frame a: R_a^T R_b and R_a^T (p_b - p_a)."""
    back = np.swapaxes(R_a, -1, -2)
    return back @ R_b, transform(back, p_b - p_a)


def relative_jacobian(
    R: FloatArray,
    p: FloatArray,
    axes: FloatArray,
    revolute: BoolArray,
    moves: FloatArray,
    R_a: FloatArray,
    p_b: FloatArray,
) -> FloatArray:
    """Velocity of frame b seen from frame a, in the axes of a, per joint rate: (N, 6, n), linear first.

    R, p are the result of `forward`. moves[j] is 1 where joint j moves b alone, -1 where it moves a alone, 0 where
    it moves both or neither: a joint that moves a alone acts on b, seen from a, with the opposite sign.
    """
    jacobian = np.zeros((len(R), 6, len(axes)))
    moving = np.flatnonzero(moves)
    turning = revolute[moving]
    screw = transform(R[:, moving + 1], np.broadcast_to(axes[moving], (len(R), len(moving), 3))) * moves[moving, None]
    arm = p_b[:, None, :] - p[:, moving + 1]
    linear = np.where(turning[:, None], np.cross(screw, arm), screw)
    angular = np.where(turning[:, None], screw, 0.0)
    jacobian[:, :3, moving] = np.swapaxes(linear @ R_a, -1, -2)
    jacobian[:, 3:, moving] = np.swapaxes(angular @ R_a, -1, -2)
    return jacobian
