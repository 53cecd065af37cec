"""Many configurations at once against one after the other."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import prs_model as prs
from prs_model.joints import ElasticJoint, along_axes
from prs_model.joints.springs import ElasticStage, Side
from prs_model.kinematics import Configurations
from prs_model.synthesis import Systems, assemble, assemble_many
from prs_model.synthesis.elimination import independent_coordinates
from tests.verification.gantry import TRAVEL, gantry

HINGE = {"joints.R.stiffness": {"ux": "rigid", "uy": 9.0e8, "uz": "rigid", "rx": 9.0e5, "ry": 9.0e5}}


def some_poses(machine: prs.Machine, count: int) -> np.ndarray:
    low, high = np.array([machine.workspace[name] for name in machine.pose_names]).T
    return low + (high - low) * np.random.default_rng(7).random((count, len(low)))


def together(machine: prs.Machine, configurations: Configurations, *more: ElasticJoint) -> Systems:
    return assemble_many(machine.description, machine.parts, (*machine.joints, *more), configurations)


def assert_same(found: np.ndarray, expected: np.ndarray) -> None:
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max(initial=0.0))


def assert_twins(machine: prs.Machine, *more: ElasticJoint, count: int = 4) -> None:
    """Matrices, output and springs of every configuration, after the rigid directions are eliminated."""
    configurations = machine.kinematics.solve_batch(some_poses(machine, count))
    systems = together(machine, configurations, *more)
    for i in range(count):
        one = assemble(machine.description, machine.parts, (*machine.joints, *more), configurations[i])
        expansion, _ = independent_coordinates(systems.constraints[i], systems.constraint_sizes[i])
        expansion = expansion[:, np.any(expansion.T @ (systems.mass[i] + systems.stiffness[i]) != 0.0, axis=1)]
        assert_same(expansion, one.expansion)
        assert_same(expansion.T @ systems.mass[i] @ expansion, one.mass)
        assert_same(expansion.T @ systems.stiffness[i] @ expansion, one.stiffness)
        assert_same(systems.output[i] @ expansion, one.output)
        assert_same(systems.output_placement[i], one.output_placement.homogeneous)
        for stack, spring in zip(systems.springs, one.springs, strict=True):
            assert (stack.joint, stack.interface) == (spring.joint, spring.interface)
            assert np.array_equal(stack.rows, spring.rows)
            assert_same(stack.displacement[i], spring.displacement)
            assert_same(stack.stiffness[i], spring.stiffness)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("head_3prs", {}),
        ("head_3prs", {"reduction.method": "craig-bampton"}),
        ("head_3prs", {"joints.S.as_printed": True}),
        ("hexapod", {}),
    ],
)
def test_machines_are_the_same_together_and_one_by_one(name: str, changes: dict[str, object]) -> None:
    assert_twins(prs.load_machine(name).replace(changes))


@pytest.mark.parametrize("method", ["reduced", "stations"])
def test_travelling_contacts_and_partly_rigid_joints_too(tmp_path: Path, method: str) -> None:
    travelling = {"reduction.coupling": "averaged", "bodies.column.interfaces.rail.travel.method": method}
    assert_twins(gantry(tmp_path, travel=TRAVEL).replace({**HINGE, **travelling}))


def test_both_ends_of_a_joint_on_one_body_and_one_on_the_ground_too() -> None:
    """A rigid link inside the rigid platform: its rows are round-off, and eliminate nothing."""
    law = along_axes(dict.fromkeys(range(6), 0.0))
    stage = ElasticStage("platform", (Side(None, pin.SE3.Identity(), law),), None, None, None)
    assert_twins(
        prs.load_machine("hexapod"),
        ElasticJoint("link", ("platform.joint_1", "platform.joint_4"), (stage,), False, False),
    )


def test_a_pose_out_of_reach_is_told_as_it_is_alone() -> None:
    machine = prs.load_machine("head_3prs")
    poses = some_poses(machine, 3)
    poses[1, -1] = 3.0
    with pytest.raises(prs.UnreachablePoseError):
        together(machine, machine.kinematics.solve_batch(poses))
