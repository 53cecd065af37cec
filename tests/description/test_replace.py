"""Changing entries of a description: by path, by instance, validated, without touching the original."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prs_model.description import MachineDescription, load_description, parse_value, replaced
from prs_model.description.schema import DiagonalStiffness
from prs_model.errors import DescriptionError

SMALL_MACHINE = Path(__file__).parent / "small_machine"


@pytest.fixture(scope="module")
def machine() -> MachineDescription:
    return load_description(SMALL_MACHINE)


def uz(machine: MachineDescription, joint: str, interface: int) -> float | None:
    stiffness = machine.joints[joint].interfaces[interface].stiffness
    assert isinstance(stiffness, DiagonalStiffness)
    return stiffness.uz


def test_a_path_is_replaced_in_units_of_the_file(machine: MachineDescription) -> None:
    changed = replaced(machine, {"joints.X.interfaces[1].stiffness.uz": parse_value("7e5")})
    assert uz(changed, "X_left", 1) == uz(changed, "X_right", 1) == 7e8
    assert uz(changed, "X_left", 0) == 6e8
    assert uz(machine, "X_left", 1) == 6e8


def test_an_instance_is_split_from_its_entry(machine: MachineDescription) -> None:
    changed = replaced(machine, {"bodies.foot_right.options.mass": 20, "joints.X_left.drive.nut": 1e5})
    assert [body.options["mass"] for name, body in changed.bodies.items() if "foot" in name] == [15.0, 20.0]
    assert list(changed.bodies) == list(machine.bodies)
    assert list(changed.joints) == list(machine.joints)
    assert changed.joints["X_right"] == machine.joints["X_right"].model_copy(update={"per": None})
    assert changed.stems == machine.stems  # stored parts are still found
    assert machine.bodies["foot_right"].options["mass"] == 15.0


def test_an_instance_splits_once(machine: MachineDescription) -> None:
    once = replaced(machine, {"bodies.foot_right.options.mass": 20})
    twice = replaced(once, {"bodies.foot_left.options.mass": 10, "bodies.foot_right.grounded": True})
    assert [twice.bodies[name].options["mass"] for name in ("foot_left", "foot_right")] == [10.0, 20.0]
    assert twice.stems["foot_left"] == "foot"


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("reduction.modes", np.int64(5)),
        ("reduction.coupling", "averaged"),
        ("joints.X.interfaces[0].at", [90, 0, 0]),
        ("joints.X.interfaces[0].at", np.array([90.0, 0.0, 0.0])),
        ("damping", {"rayleigh": {"alpha": 1, "beta": 1e-5}}),
        ("joints.levelling", {"frame": "bed", "between": ["ground", "bed.floor"], "rigid": True}),
        ("title", "other"),
    ],
)
def test_what_may_be_replaced(machine: MachineDescription, path: str, value: Any) -> None:
    assert replaced(machine, {path: value}).raw != machine.raw


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("bodies.foo.modes", 5, "did you mean 'foot'"),
        ("bodies.foot_lft.modes", 5, "did you mean 'foot_left'"),
        ("bodies.foot.modez", 5, "did you mean 'modes'"),
        ("joints.X.interfaces[2].at", [0, 0, 0], "a list of 2"),
        ("joints.X.interface[0].at", [0, 0, 0], "did you mean 'interfaces'"),
        ("bodies.new", "x", "no such entry"),
        ("bodies..foot", 5, "cannot be read"),
        ("", 5, "cannot be read"),
        ("bodies.foot.modes", -1, "bodies.foot.modes: "),
        ("bodies.foot.options.mass", float("nan"), "finite number"),
        ("bodies.foot_left.frame", "fot_left", "did you mean 'foot_left'"),
        ("task.kind", "planar", "task.workspace"),
    ],
)
def test_what_may_not_be_replaced(machine: MachineDescription, path: str, value: Any, words: str) -> None:
    with pytest.raises(DescriptionError) as caught:
        replaced(machine, {path: value})
    assert words in str(caught.value)


def test_a_changed_entry_is_not_said_to_stand_in_the_file(machine: MachineDescription) -> None:
    with pytest.raises(DescriptionError) as caught:
        replaced(machine, {"joints.X.drive.nut": -1})
    assert str(caught.value).startswith("machine.yaml: joints.X.drive.nut: found -1")


def test_entries_of_lists_go_by_number_or_name() -> None:
    head = load_description(Path(__file__).parents[2] / "machines" / "prs_machines" / "head_3prs")
    for path in ("joints.R.interfaces[1].stiffness.ux", "joints.R.interfaces.b2.stiffness.ux"):
        assert float(replaced(head, {path: 1.0e6}).joints["R_2"].interfaces[1].stiffness.ux) == pytest.approx(1e9)
    stiffer = replaced(head, {"joints.S_2.stages.s4_2.stiffness.ux": 2.0e5})
    assert float(stiffer.joints["S_2"].stages[1].stiffness.ux) == pytest.approx(2e8)
    with pytest.raises(
        DescriptionError, match=r"found '0' in a list, expected one of b1, b2, or a number such as \[0\]"
    ):
        replaced(head, {"joints.R.interfaces.0.stiffness.ux": 1.0e6})


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("reduction.coupling", "stiff", "expected one of rigid, averaged"),
        ("reduction.modes", -1, "found -1, expected 0 or more"),
        ("damping", {"rayleigh": {"alpha": 1.0, "beta": -1.0}}, r"expected zero or more \(s\)"),
    ],
)
def test_a_mistake_beside_parts_without_their_meshes_is_told_alone(path: str, value: object, words: str) -> None:
    """head_3prs ships reduced parts, no meshes: a store that cannot be read must not make every mesh a problem."""
    head = load_description(Path(__file__).parents[2] / "machines" / "prs_machines" / "head_3prs")
    with pytest.raises(DescriptionError, match=words) as caught:
        replaced(head, {path: value})
    assert len(caught.value.problems) == 1
