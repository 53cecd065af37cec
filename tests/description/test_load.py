"""A sound machine: symmetry expanded, everything in SI, sources remembered."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from prs_model.description import json_schema, load_description
from prs_model.description.quantity import Quantity
from prs_model.description.schema import AXES, DiagonalStiffness, MachineFile
from prs_model.description.units import Dimension, Units

SMALL_MACHINE = Path(__file__).parent / "small_machine"


def test_symmetry_is_expanded() -> None:
    machine = load_description(SMALL_MACHINE)
    assert list(machine.bodies) == ["bed", "foot_left", "foot_right", "bridge", "ram"]
    assert list(machine.joints) == ["levelling", "X_left", "X_right", "seat_left", "seat_right", "ram"]
    assert machine.bodies["foot_right"].frame == "foot_right"
    assert machine.joints["X_right"].between == ("bed.rail_right", "foot_right.below")
    assert machine.stems["foot_left"] == "foot"
    assert machine.stems["X_right"] == "X"
    assert machine.stems["bridge"] == "bridge"


def test_values_are_in_si() -> None:
    machine = load_description(SMALL_MACHINE / "machine.yaml")
    assert machine.reference_pose == pytest.approx({"x": 0.4, "y": 0.0, "z": 0.6})
    assert list(machine.reference_joints) == ["x_left", "y", "z", "x_right"]
    assert machine.reference_joints["x_right"] == pytest.approx(0.4)
    assert machine.workspace["y"] == pytest.approx((-0.3, 0.3))
    assert machine.bodies["foot_left"].options["nodes"]["above"] == pytest.approx((0.0, 0.0, 0.7))
    assert machine.bodies["ram"].options["inertia"]["xx"] == pytest.approx(0.8)
    stiffness = machine.joints["X_left"].interfaces[1].stiffness
    assert isinstance(stiffness, DiagonalStiffness)
    assert [getattr(stiffness, axis) for axis in AXES] == [None, 4.0e8, 6.0e8, 1.0e6, 1.0e6, 1.0e6]


def test_numbers_remember_their_source() -> None:
    machine = load_description(SMALL_MACHINE)
    mass = machine.bodies["ram"].options["mass"]
    assert isinstance(mass, Quantity)
    assert mass.source == "measured"
    stiffness = machine.joints["ram"].stages[0].stiffness
    assert isinstance(stiffness, DiagonalStiffness)
    assert stiffness.ux is not None
    assert (stiffness.ux.source, stiffness.ux.note) == ("catalogue", "two carriages")


def test_an_error_of_somebody_else_can_have_its_line() -> None:
    error = load_description(SMALL_MACHINE).problem(("task", "reference"), "does not close the loops")
    assert str(error) == "machine.yaml:13: task.reference: does not close the loops"


def test_json_schema_names_every_section() -> None:
    schema = json.loads(json.dumps(json_schema(), allow_nan=False))
    assert set(schema["properties"]) == set(MachineFile.model_fields)
    assert schema["additionalProperties"] is False
    modes = schema["$defs"]["Body"]["properties"]["modes"]
    assert {"type": "integer", "minimum": 0} in modes["anyOf"]
    number = schema["$defs"]["BallScrew"]["properties"]["nut"]["anyOf"][0]
    assert number == {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"const": "rigid"}]}


@pytest.mark.parametrize(
    ("system", "force"), [("mm-N-tonne-s", 1.0), ("m-N-kg-s", 1.0), ("in-lbf-slinch-s", 4.4482216)]
)
def test_consistent_units_of_part_files(system: str, force: float) -> None:
    """One unit of force accelerates one unit of mass by one unit of length per second squared."""
    units = Units.parse(system)
    assert Dimension(force=1).factor(units) == pytest.approx(force)
    assert Dimension(mass=1, length=1).factor(units) == pytest.approx(Dimension(force=1).factor(units))


@pytest.mark.parametrize(
    ("system", "words"),
    [("mm-N-kg-s", "not consistent"), ("mm-N-tonne", "length-force-mass-time"), ("mn-N-tonne-s", "found unit 'mn'")],
)
def test_units_that_do_not_fit(system: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Units.parse(system)


def test_degrees_are_read_for_angles(tmp_path: Path) -> None:
    """The same machine with its z axis turned into a hinge: the joint's value is an angle in the file's unit."""
    for name, old, new in [
        ("gantry.urdf", 'name="z" type="prismatic"', 'name="z" type="continuous"'),
        ("machine.yaml", "z: -100", "z: -90"),
        ("machine.yaml", "compliance: {ux: 1.0e-6, uy: 1.0e-6, rx: 0, ry: 0, rz: 0}", "rigid: true"),
        (
            "machine.yaml",
            "rigid: true\n        drive: {kind: constant, stiffness:",
            "rigid: true\n        drive: {kind: constant, rotational_stiffness:",
        ),
    ]:
        source = tmp_path / name if (tmp_path / name).exists() else SMALL_MACHINE / name
        text = source.read_text()
        assert old in text
        (tmp_path / name).write_text(text.replace(old, new))
    machine = load_description(tmp_path)
    assert machine.reference_joints["z"] == pytest.approx(-math.pi / 2)
    drive = machine.joints["ram"].stages[1].drive
    assert drive is not None
    assert drive.kind == "constant"
    assert drive.rotational_stiffness == pytest.approx(200.0)  # 2e5 N mm/rad
