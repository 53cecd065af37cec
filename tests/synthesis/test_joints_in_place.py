"""Joints where they need not be: inside a rigid body, missing, or holding nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import prs_model as prs
from prs_model.joints import along_axes
from prs_model.joints.springs import ElasticJoint, ElasticStage, Side
from prs_model.synthesis import System, assemble, wide_joints
from tests.verification.gantry import TRAVEL, gantry


@pytest.fixture(scope="module")
def hexapod() -> prs.Machine:
    return prs.load_machine("hexapod")


def with_link_inside_the_platform(machine: prs.Machine, compliance: float) -> System:
    law = along_axes(dict.fromkeys(range(6), compliance))
    stage = ElasticStage("platform", (Side(None, pin.SE3.Identity(), law),), None, None, None)
    link = ElasticJoint("link", ("platform.joint_1", "platform.joint_4"), (stage,), False, False)
    return assemble(machine.description, machine.parts, (*machine.joints, link), machine.configuration())


@pytest.mark.parametrize("compliance", [1e-9, 0.0])
def test_a_link_inside_a_rigid_body_changes_nothing(hexapod: prs.Machine, compliance: float) -> None:
    linked = with_link_inside_the_platform(hexapod, compliance)
    assert linked.size == 6
    np.testing.assert_allclose(linked.modes(6).frequencies, hexapod.modes(6).frequencies, rtol=1e-9)


def test_without_drives_the_hexapod_is_a_mechanism(hexapod: prs.Machine) -> None:
    """Six rigid-body modes, at zero and without strain energy."""
    limp = [
        replace(joint, stages=tuple(replace(stage, drive=None) for stage in joint.stages)) for joint in hexapod.joints
    ]
    modes = assemble(hexapod.description, hexapod.parts, limp, hexapod.configuration()).modes(6)
    np.testing.assert_array_equal(modes.frequencies, 0.0)
    assert not any(share.any() for share in modes.strain_energy().values())


def test_systems_cannot_be_changed_by_accident(hexapod: prs.Machine) -> None:
    with pytest.raises(ValueError, match="read-only"):
        hexapod.assemble().mass[0, 0] = 1.0


def test_ends_that_lie_apart_are_told(hexapod: prs.Machine) -> None:
    """A node written 80 mm from its joint, and a sound machine."""
    moved = hexapod.replace({"bodies.platform.options.nodes.joint_2": (0.0578, 0.0689, 0.065)})
    for machine, expected in ((hexapod, {}), (moved, {"S_2": pytest.approx(0.08, rel=1e-2)})):
        assert wide_joints(machine.description, machine.parts, machine.joints, machine.configuration()) == expected


def test_ends_tied_in_two_ways_are_not_apart(tmp_path: Path) -> None:
    """One body has a node for each of two places 150 mm apart, the other one node: that is no fault of the file."""
    apart = {"reduction.tie": "interface", "bodies.table.tie": "joint"}
    tied = gantry(tmp_path).replace(apart)
    assert not wide_joints(tied.description, tied.parts, tied.joints, tied.configuration())
    moved = tied.replace({"bodies.table.interfaces.rail.at": [0.125, 0.09, 0.0]})
    found = wide_joints(moved.description, moved.parts, moved.joints, moved.configuration())
    assert found == {"X": pytest.approx(0.04, rel=0.01)}


def test_a_drive_takes_hold_where_the_contact_is(tmp_path: Path) -> None:
    """With nodes at all stations, at one of them: a subspace of the complete order, with nothing softened."""
    machine = gantry(tmp_path, travel=TRAVEL).replace(
        {
            "reduction.tie": "interface",
            "reduction.coupling": "averaged",
            "bodies.column.interfaces.rail.travel.method": "stations",
        }
    )
    complete = machine.complete_order().modes(machine.configuration(x=0.445), 6).frequencies
    assert np.all(machine.modes(6, x=0.445).frequencies > complete * (1.0 - 1e-8))
