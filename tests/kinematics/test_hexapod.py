"""The hexapod: no closed form, 36 joints, strut lengths known from geometry."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import eigh, null_space
from scipy.spatial.transform import Rotation

from prs_model.kinematics import Kinematics
from prs_model.kinematics.tree import pinocchio_values

REFERENCE = np.array([0.0, 0.0, 0.09, 0.0, 0.0, 0.0])
RANGE = np.array([0.003, 0.003, 0.003, *np.radians([3.0, 3.0, 3.0])])


def circle(radius: float, degrees: list[int], z: float) -> np.ndarray:
    angles = np.radians(degrees)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(6, z)])


BASE = circle(0.115, [-10, 10, 110, 130, 230, 250], 0.015)
PLATFORM = circle(0.090, [-50, 50, 70, 170, 190, -70], -0.015)


def struts(hexapod: Kinematics) -> list[int]:
    return [hexapod.tree.joint(f"strut_{limb}") for limb in range(1, 7)]


def test_strut_lengths_and_loops_at_many_poses(hexapod: Kinematics, rng: np.random.Generator) -> None:
    poses = REFERENCE + rng.uniform(-1, 1, (3_000, 6)) * RANGE
    batch = hexapod.solve_batch(poses)
    assert batch.reachable.all()
    assert batch.closure_residual.max() < 1e-10
    turned = Rotation.from_rotvec(poses[:, 3:]).as_matrix()
    ends = poses[:, None, :3] + np.einsum("nij,kj->nki", turned, PLATFORM)
    lengths = np.linalg.norm(ends - BASE, axis=2)
    assert np.abs(batch.q[:, struts(hexapod)] - lengths).max() < 1e-9


def test_pinocchio_agrees_pose_by_pose(hexapod: Kinematics, rng: np.random.Generator) -> None:
    poses = REFERENCE + rng.uniform(-1, 1, (20, 6)) * RANGE
    batch = hexapod.solve_batch(poses)
    for i, pose in enumerate(poses):
        twin = hexapod.newton(dict(zip(hexapod.pose_names, pose, strict=True)))
        assert np.abs(twin.q - batch.q[i]).max() < 1e-9


def test_rigid_platform_on_springs_has_the_published_frequencies(hexapod: Kinematics) -> None:
    """K and CRBA mass restricted to the motions that the loops allow; tdehaeze/stewart-simscape, identification.org."""
    reference = hexapod.solve(dict(zip(hexapod.pose_names, REFERENCE, strict=True)))
    model = hexapod.model
    upper = np.triu(pin.crba(model, model.createData(), pinocchio_values(model, reference.q)))
    mass = upper + np.triu(upper, 1).T
    stiffness = np.zeros_like(mass)
    stiffness[struts(hexapod), struts(hexapod)] = 2e7
    frames = hexapod.tree.forward(reference.q[None])
    rows = hexapod.equations.jacobian(frames, REFERENCE[None])[0, : hexapod.equations.loop_rows]
    allowed = null_space(rows)
    values = eigh(allowed.T @ stiffness @ allowed, allowed.T @ mass @ allowed, eigvals_only=True)
    published = [780.6, 780.6, 903.9, 1061.4, 1061.4, 1269.6]
    assert np.sqrt(values) / (2 * np.pi) == pytest.approx(published, abs=0.1)


def test_a_strut_that_is_too_short(hexapod: Kinematics) -> None:
    batch = hexapod.solve_batch(np.array([[0.0, 0.0, 0.12, 0.0, 0.0, 0.0]]))
    assert not batch.reachable[0]
    assert "(limb " in batch.reasons[0]
    assert "limits 80 .. 110 mm" in batch.reasons[0]
