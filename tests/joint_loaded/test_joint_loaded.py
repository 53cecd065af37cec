"""Joint-loaded parts against the complete order of the same machine, with averaged interfaces."""

import numpy as np
import pytest

from tests.verification.gantry import SIZES, gantry

POSES = ({}, {"x": 0.45, "phi": 0.8}, {"x": 0.3, "y": -0.05, "phi": -0.6})
AVERAGED = {"reduction": {"method": "joint-loaded", "modes": 3}}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return gantry(tmp_path_factory.mktemp("gantry")).replace(AVERAGED)


@pytest.fixture(scope="module")
def complete(machine):
    order = machine.complete_order("averaged")
    return [order.modes(machine.configuration(**pose), 8).frequencies for pose in POSES]


def test_frequencies_lie_little_above_the_complete_order(machine, complete):
    for pose, exact in zip(POSES, complete, strict=True):
        error = machine.modes(8, **pose).frequencies / exact - 1.0
        assert error.min() > -1e-8
        assert error.max() < 0.01


def test_more_modes_come_nearer(machine, complete):
    errors = [
        machine.replace({"reduction.modes": count}).modes(8).frequencies / complete[0] - 1.0 for count in (0, 3, 12)
    ]
    assert np.all(np.diff(errors, axis=0) < 1e-9)
    assert errors[-1].max() < 2e-4


def test_far_fewer_coordinates_than_one_node_per_interface(machine):
    craig_bampton = {"reduction": {"method": "craig-bampton", "coupling": "averaged", "tie": "interface", "modes": 3}}
    assert machine.assemble().size < 0.85 * machine.replace(craig_bampton).assemble().size


RIGID = [
    {"name": "near", "at": [0.05, 0.05, 0.0], "rigid": True},
    {"name": "far", "at": [0.2, 0.05, 0.0], "rigid": True},
]
PARTLY = {"ux": "rigid", "uz": "rigid", "rx": 8.0e5, "ry": "rigid", "rz": 8.0e5}


@pytest.mark.parametrize(
    "changes", [{"joints.X.interfaces": RIGID}, {"joints.Y.stiffness": PARTLY}], ids=["contacts", "directions"]
)
def test_what_is_rigid_bends_with_the_parts(machine, changes):
    """Two rigid contacts of one joint do not hold the parts between them straight."""
    stiff = machine.replace(changes)
    exact = stiff.complete_order("averaged").modes(stiff.configuration(), 8).frequencies
    error = stiff.modes(8).frequencies / exact - 1.0
    assert error.min() > -1e-8
    assert error.max() < 0.01


def test_what_the_joints_leave_free_stays_free(machine):
    """An arm whose bearing has no drive turns at zero frequency, exactly as the full model does."""
    loose = machine.replace(
        {"joints.R.drive": {"kind": "constant", "rotational_stiffness": 1e-12}, "reduction.modes": 0}
    )
    free = machine.replace({"joints.R.drive": None, "reduction.modes": 0})
    assert free.modes(3).frequencies[0] == 0.0
    assert free.modes(3).frequencies[1:] == pytest.approx(loose.modes(3).frequencies[1:], rel=1e-6)


def test_compliance_at_single_node_joints_is_exact(machine):
    """Loads on the tool, a node that no joint holds, reach the table through joints of one node: nothing is lost."""

    def tip(reduced):
        system = reduced.assemble()
        return system.output @ np.linalg.solve(system.stiffness, system.output.T)

    full = {"reduction": {"method": "craig-bampton", "coupling": "averaged", "tie": "interface", "modes": 0}}
    one_contact = {
        "urdf": "slide_x",
        "between": ["column.rail", "table.rail"],
        "stiffness": {"uy": 8e8, "uz": 1e9, "rx": 9e6, "ry": 9e6, "rz": 9e6},
        "drive": {"kind": "constant", "stiffness": 1e8},
    }
    single = machine.replace({"joints.X": one_contact})
    lumped = {"bodies.column.interfaces.rail.tie": "joint", "bodies.table.interfaces.rail.tie": "joint"}
    assert tip(single.replace(lumped)) == pytest.approx(tip(single.replace({**full, **lumped})), rel=1e-9)
    assert tip(machine) == pytest.approx(tip(machine.replace(full)), rel=5e-3)


def test_joint_data_may_change_without_stale_shapes(machine):
    """The shapes are those of the joints as they are, so softer or stiffer ones are met as well."""
    for factor in (0.1, 10.0):
        changed = machine.replace({f"joints.{name}.stiffness_factor": factor for name in "XYR"})
        exact = changed.complete_order("averaged").modes(changed.configuration(), 8).frequencies
        error = changed.modes(8).frequencies / exact - 1.0
        assert error.min() > -1e-8
        assert error.max() < 0.01


FOUNDATION = {
    "frame": "column",
    "between": ["ground", "column.foot"],
    "stiffness": {"ux": 6e8, "uy": 6e8, "uz": 9e8, "rx": 8e6, "ry": 8e6, "rz": 8e6},
}
FOOT = {"joints.foundation": FOUNDATION, "bodies.column.clamped": [], "bodies.column.grounded": False}


@pytest.mark.parametrize("count", [0, 3])
def test_a_body_that_a_joint_holds_to_the_ground_keeps_its_mass(machine, count):
    standing = machine.replace({**FOOT, "bodies.column.interfaces.foot": {"set": "z0"}, "reduction.modes": count})
    assert standing.parts["column"].mass_properties().mass == pytest.approx(
        np.prod(SIZES["column"][0]) * 7850.0, rel=1e-6
    )
    exact = standing.complete_order("averaged").modes(standing.configuration(), 8).frequencies
    error = standing.modes(8).frequencies / exact - 1.0
    assert error.min() > -1e-8
    assert error.max() < 0.05


def test_modes_of_one_body_are_taken_exactly(machine):
    sizes = {
        count: machine.replace({"reduction.modes": 0, "bodies.arm.modes": count}).parts["arm"].size
        for count in (0, 2, 5)
    }
    assert sizes[2] - sizes[0] == 2
    assert sizes[5] - sizes[0] == 5
