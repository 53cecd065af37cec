"""A planar 3-RRR mechanism in a tilted plane: 12 closure rows of rank 6, measured away from the root link."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from prs_model import DescriptionError
from prs_model.kinematics import Kinematics

from .mechanisms import Robot, crank_angles, machine, planar_3rrr


@pytest.mark.parametrize("loop", ["frame", "point"])
def test_redundant_rows_do_no_harm(tmp_path: Path, loop: str, rng: np.random.Generator) -> None:
    planar = planar_3rrr(tmp_path, loop=loop)
    jacobian = planar.equations.jacobian(planar.tree.forward(planar.branch.q[None]), np.zeros((1, 3)))[0]
    rows = planar.equations.loop_rows
    assert rows == {"frame": 12, "point": 6}[loop]
    assert np.linalg.matrix_rank(jacobian[:rows], rtol=1e-9) == {"frame": 6, "point": 4}[loop]

    poses = rng.uniform([-0.05, -0.05, -0.3], [0.05, 0.05, 0.3], (200, 3))
    batch = planar.solve_batch(poses)
    assert batch.reachable.all()
    assert batch.closure_residual.max() < 1e-10
    assert np.abs(batch.q[:, planar.tree.joint("a_2")] - crank_angles(poses)).max() < 1e-9
    for i in range(10):
        twin = planar.newton(dict(zip(planar.pose_names, poses[i], strict=True)))
        assert np.abs(twin.q - batch.q[i]).max() < 1e-9


def test_placements_are_seen_from_the_root(tmp_path: Path) -> None:
    planar = planar_3rrr(tmp_path)
    configuration = planar.solve({"x": 0.02, "y": -0.03, "phi": 0.2})
    plate = configuration.placement("plane").inverse() * configuration.placement("plate")
    np.testing.assert_allclose(plate.translation, [0.02, -0.03, 0.0], atol=1e-12)
    np.testing.assert_allclose(plate.rotation[:2, 0], [np.cos(0.2), np.sin(0.2)], atol=1e-12)


def test_continuous_joints_are_one_angle(tmp_path: Path) -> None:
    planar = planar_3rrr(tmp_path)
    assert planar.model.nq == 2 * planar.model.nv == 18
    configuration = planar.solve({"x": 0.01, "y": 0.0, "phi": 0.1})
    assert configuration.q.shape == (9,)
    q = planar.pinocchio_values(configuration)
    assert q[0] == pytest.approx(np.cos(configuration.joint_values["a_1"]))


def test_task_with_too_many_coordinates(tmp_path: Path) -> None:
    """A five-bar has two degrees of freedom, whatever its six closure rows suggest."""
    with pytest.raises(DescriptionError) as caught:
        five_bar(tmp_path)
    message = str(caught.value)
    assert "machine.yaml:4: task.kind: found 3 coordinates in task 'planar', expected 2, the degrees" in message
    assert "(5 joints less closures of rank 3)" in message


def five_bar(folder: Path) -> Kinematics:
    robot = Robot("base")
    robot.add("a_1", "revolute", "base", "crank_1", (-0.2, 0, 0))
    robot.add("b_1", "revolute", "crank_1", "coupler_1", (0.3, 0, 0))
    robot.add("a_2", "revolute", "base", "crank_2", (0.2, 0, 0))
    robot.add("b_2", "revolute", "crank_2", "coupler_2", (0.3, 0, 0))
    robot.add("c_2", "revolute", "coupler_2", "end_2", (0.3, 0, 0))
    robot.add("end_1_mount", "fixed", "coupler_1", "end_1", (0.3, 0, 0))
    up, tip = np.pi / 2, np.arcsin(0.2 / 0.3)
    joints = {"a_1": up, "b_1": -tip, "a_2": up, "b_2": tip, "c_2": -2 * tip}
    pose = {"x": 0.0, "y": float(0.3 + 0.3 * np.cos(tip)), "phi": float(up - tip)}
    closures = [("end_1", "end_2", "frame")]
    joints = {name: float(value) for name, value in joints.items()}
    return machine(folder, robot, kind="planar", frame="end_1", pose=pose, joints=joints, closures=closures)
