"""Jacobians against central differences, away from the closure too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from prs_model.kinematics import Kinematics, kernels

from .mechanisms import planar_3rrr
from .test_reference import gantry


def check(kinematics: Kinematics, q: np.ndarray, targets: np.ndarray) -> None:
    equations, tree, step = kinematics.equations, kinematics.tree, 1e-6
    ahead, behind = (
        equations.residual(tree.forward(q + sign * step * np.eye(tree.size)), np.repeat(targets, tree.size, axis=0))
        for sign in (1, -1)
    )
    differences = (ahead - behind).T / (2 * step)
    exact = equations.jacobian(tree.forward(q[None]), targets)[0]
    np.testing.assert_allclose(exact, differences, atol=2e-9)


def test_nutation_precession_z_with_frame_loops(head: Kinematics, rng: np.random.Generator) -> None:
    q = head.branch.q + rng.normal(scale=0.3, size=15)
    check(head, q, head.task.targets(np.array([[0.3, 1.0, 1.2]])))


def test_pose_6dof(hexapod: Kinematics, rng: np.random.Generator) -> None:
    check(hexapod, hexapod.branch.q + rng.normal(scale=0.3, size=36), rng.normal(scale=0.5, size=(1, 6)))


@pytest.mark.parametrize("loop", ["frame", "point"])
def test_planar_measured_in_another_frame(tmp_path: Path, loop: str, rng: np.random.Generator) -> None:
    planar = planar_3rrr(tmp_path, loop=loop)
    check(planar, planar.branch.q + rng.normal(scale=0.3, size=planar.tree.size), rng.normal(size=(1, 3)))


def test_xyz(tmp_path: Path, rng: np.random.Generator) -> None:
    kinematics = gantry(tmp_path, joints={"x": 0.0, "y": 0.0, "z": 0.0})
    check(kinematics, rng.normal(size=3), rng.normal(size=(1, 3)))


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 9.9e-5, 1.1e-4, 0.1, 2.0, 3.0, np.pi - 1e-7])
def test_rotation_vectors_at_all_sizes(angle: float, rng: np.random.Generator) -> None:
    axis = rng.normal(size=(50, 3))
    vector = angle * axis / np.linalg.norm(axis, axis=1, keepdims=True)
    R = kernels.rotation(vector)
    np.testing.assert_allclose(R, Rotation.from_rotvec(vector).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(kernels.rotation_vector(R), vector, atol=1e-15 + 1e-15 * angle, rtol=1e-14)
