"""Entries of one limb alone: the other limbs keep their shapes, and nothing of the limb is overlooked."""

import numpy as np
import pytest

import prs_model as prs


@pytest.fixture(scope="module")
def head():
    return prs.load_machine("head_3prs")


def sizes(machine, body):
    return [machine.parts[f"{body}_{limb}"].size for limb in (1, 2, 3)]


def test_modes_of_one_limb(head):
    one, two, three = sizes(head.replace({"bodies.rod_2.modes": 5}), "rod")
    static = sizes(head.replace({"reduction.modes": 0}), "rod")
    assert two == static[1] + 5
    assert one == three


@pytest.mark.parametrize(
    "changes",
    [
        {"joints.P_2.drive": None},
        {"joints.R_2.interfaces.b1.stiffness.ux": "rigid", "joints.R_2.interfaces.b2.stiffness.ux": "rigid"},
        {"joints.R_3.interfaces.b1.stiffness.uy": 0.0},
    ],
    ids=["no drive", "rigid", "floating"],
)
def test_joints_of_one_limb(head, changes):
    changed = head.replace(changes)
    exact = changed.replace({"reduction.method": "craig-bampton", "reduction.modes": 3})
    frequencies = changed.modes(8).frequencies
    assert np.all(np.isfinite(frequencies))
    assert np.all(frequencies <= exact.modes(8).frequencies * 1.001)
