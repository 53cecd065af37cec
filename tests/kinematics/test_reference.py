"""The reference configuration is checked when the kinematics is built, and named with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from prs_model import DescriptionError, PrsError, UnknownNameError
from prs_model.description import load_description
from prs_model.kinematics import Kinematics

from .mechanisms import Robot, machine

ROD = "0.34999999999999998"  # as written in the URDF


def gantry(folder: Path, *, joints: dict[str, float], pose: dict[str, float] | None = None) -> Kinematics:
    robot = Robot("base")
    robot.add("x", "prismatic", "base", "bridge", axis=(1, 0, 0))
    robot.add("y", "prismatic", "bridge", "carriage", axis=(0, 1, 0))
    robot.add("z", "prismatic", "carriage", "ram", (0, 0, 0.5), axis=(0, 0, 1))
    return machine(folder, robot, kind="xyz", frame="ram", pose=pose or {"x": 0.0, "y": 0.0, "z": 0.5}, joints=joints)


def test_open_chain_without_closures(tmp_path: Path) -> None:
    kinematics = gantry(tmp_path, joints={"x": 0.0, "y": 0.0, "z": 0.0})
    assert kinematics.solve({"x": 2.0, "y": -1.0, "z": 0.7}).q == pytest.approx([2.0, -1.0, 0.2])
    assert kinematics.solve_batch(np.zeros((0, 3))).q.shape == (0, 3)


def test_small_differences_are_corrected(tmp_path: Path) -> None:
    kinematics = gantry(tmp_path, joints={"x": 4e-4, "y": 0.0, "z": 0.0})
    assert kinematics.solve({"x": 0.0, "y": 0.0, "z": 0.5}).q == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_joint_values_of_another_pose(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError) as caught:
        gantry(tmp_path, joints={"x": 0.1, "y": 0.0, "z": 0.0})
    assert "machine.yaml:10: task.reference.joints.x: found 100 mm for x, expected 0 mm" in str(caught.value)


def test_joint_values_that_close_nothing(tmp_path: Path) -> None:
    robot = Robot("base")
    robot.add("turn", "revolute", "base", "arm")
    robot.add("lift", "prismatic", "arm", "hand", (1.0, 0, 0), axis=(1, 0, 0), limits=(0, 1))
    robot.add("post_mount", "fixed", "base", "post", (0, 0, 0.4))
    pose = {"x": 1.0, "y": 0.0, "phi": 0.0}
    with pytest.raises(DescriptionError) as caught:
        machine(
            tmp_path,
            robot,
            kind="planar",
            frame="hand",
            pose=pose,
            joints={"turn": 0.0, "lift": 0.0},
            closures=[("hand", "post", "point")],
        )
    assert "machine.yaml:8: task.reference: found joint values near which nothing closes" in str(caught.value)
    assert "as stored: loop_2 open by 1, the pose missed by 0 m or rad" in str(caught.value)


def test_a_pose_that_cannot_be_met_is_not_blamed_on_the_loops(tmp_path: Path) -> None:
    robot = Robot("base")
    robot.add("x", "prismatic", "base", "slide", axis=(1, 0, 0))
    with pytest.raises(DescriptionError, match=r"task\.reference: .* \(as stored: the pose missed by 0\.3 m or rad\)"):
        machine(tmp_path, robot, kind="xyz", frame="slide", pose={"x": 0.0, "y": 0.3, "z": 0.0}, joints={"x": 0.0})


def structure(folder: Path, gap: float) -> Kinematics:
    """Two arms on one base whose ends are closed to each other; nothing moves."""
    robot = Robot("base")
    robot.add("left_mount", "fixed", "base", "left", (0.2, 0, 0))
    robot.add("right_mount", "fixed", "base", "right", (0.2, gap, 0))
    return machine(folder, robot, kind="fixed", frame="left", pose={}, joints={}, closures=[("left", "right", "frame")])


def test_a_structure_that_closes(tmp_path: Path) -> None:
    kinematics = structure(tmp_path, 0.0)
    for configuration in (kinematics.solve({}), kinematics.newton({})):
        assert configuration.q.shape == (0,)
        assert configuration.placement("right").translation == pytest.approx([0.2, 0.0, 0.0])


def test_a_structure_that_does_not_close(tmp_path: Path) -> None:
    words = r"closures: found links that do not meet, and no joint that moves \(loop_2 open by 0\.01 m or rad\)"
    with pytest.raises(DescriptionError, match=words):
        structure(tmp_path, 0.01)


def test_a_tool_frame_that_no_joint_moves(tmp_path: Path) -> None:
    robot = Robot("base")
    robot.add("x", "prismatic", "base", "slide", axis=(1, 0, 0))
    robot.add("post_mount", "fixed", "base", "post", (0, 0, 0.4))
    with pytest.raises(DescriptionError, match=r"task\.frame: found 'post', which no joint moves relative to 'base'"):
        machine(tmp_path, robot, kind="xyz", frame="post", pose={"x": 0.0, "y": 0.0, "z": 0.4}, joints={"x": 0.0})


def test_a_urdf_that_pinocchio_refuses(tmp_path: Path) -> None:
    gantry(tmp_path, joints={"x": 0.0, "y": 0.0, "z": 0.0})
    description = load_description(tmp_path)
    description.urdf_path.write_text("<robot name='mechanism'><link name=")
    with pytest.raises(DescriptionError, match=r"mechanism\.urdf: Pinocchio cannot read it \(.+\); correct the URDF"):
        Kinematics(description)


def test_closed_form_for_another_geometry(tmp_path: Path, head: Kinematics) -> None:
    folder = head.description.folder
    for name in ("machine.yaml", "head_3prs.urdf"):
        (tmp_path / name).write_text((folder / name).read_text())
    urdf = tmp_path / "head_3prs.urdf"
    text = urdf.read_text()
    assert text.count(f'xyz="0 0 {ROD}"') == 3
    urdf.write_text(text.replace(f'xyz="0 0 {ROD}"', f'xyz="0 0.0001 {ROD}"'))  # S centres off the rods' axes
    with pytest.raises(DescriptionError, match=r"task.kind: found a closed form that leaves the loops .* correct it"):
        Kinematics(load_description(tmp_path))


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ({"x": 0.0, "y": 0.0}, "no value for z, expected x, y, z"),
        ({"x": 0.0, "y": float("nan"), "z": 0.0}, "found nan for y"),
        ({"x": 0.0, "y": 1e308, "z": 0.0}, r"pose: found 1e\+308 for y, expected a number between -1,000,000 and"),
        ({"x": "a", "y": 0.0, "z": 0.0}, "found 'a' for x, expected one number"),
        ({"x": [1, 2], "y": 0.0, "z": 0.0}, r"found \[1, 2\] for x, expected one number"),
        ({"x": True, "y": 0.0, "z": 0.0}, "found True for x"),
    ],
)
def test_poses_that_are_none(tmp_path: Path, pose: dict[str, float], words: str) -> None:
    kinematics = gantry(tmp_path, joints={"x": 0.0, "y": 0.0, "z": 0.0})
    with pytest.raises(PrsError, match=words):
        kinematics.solve(pose)
    with pytest.raises(UnknownNameError, match="Did you mean 'z'"):
        kinematics.solve({"x": 0.0, "y": 0.0, "zz": 0.0})
    with pytest.raises(PrsError, match=r"shape \(3,\)"):
        kinematics.solve_batch(np.zeros(3))
    with pytest.raises(PrsError, match="no array of numbers"):
        kinematics.solve_batch([["a", "b", "c"]])
