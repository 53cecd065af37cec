"""Reduced models held against the complete order of a small gantry."""

import json

import numpy as np
import pytest

import prs_model as prs
from prs_model.verification import (
    REDUCTIONS,
    curve_of,
    default_poses,
    grid_poses,
    random_poses,
    reductions_named,
    verify,
    with_joint_stiffness,
)
from prs_model.verification.pages import page
from prs_model.verification.plain import as_dict
from prs_model.verification.report import relative_difference
from tests.verification.gantry import TRAVEL, gantry

POSES = "verification: {poses: {x: [0.3, 0.45], phi: [0.5]}, published: {measured: [100, 150]}}\n"
COUNT = 6
AVERAGED = ("averaged-interface", "joint-loaded")


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return gantry(tmp_path_factory.mktemp("gantry"), POSES)


@pytest.fixture(scope="module")
def report(machine):
    return verify(machine, count=COUNT, curve=curve_of(reductions_named(["averaged-interface"]), (0, 2, 8)))


def test_every_reduction_is_compared_with_every_model_at_every_pose(report):
    assert [dict(pose) for pose in report.poses] == [
        {"x": 0.375, "y": 0.025, "phi": 0.0},
        {"x": 0.3, "y": 0.025, "phi": 0.5},
        {"x": 0.45, "y": 0.025, "phi": 0.5},
    ]
    assert len(report.comparisons) == 2 * (len(REDUCTIONS) + 3)
    assert all(
        each.discrepancies.shape == (3, COUNT) and each.mac.shape == (3, COUNT, COUNT) for each in report.comparisons
    )
    assert all(run.residuals[:, :COUNT].max() < 1e-4 for run in report.models)


def test_discrepancies_are_those_of_the_frequencies(machine, report):
    pose = dict(report.poses[1])
    complete = machine.complete_order("rigid").modes(machine.configuration(**pose), COUNT).frequencies
    reduced = machine.replace({"reduction.modes": 3}).modes(COUNT, **pose).frequencies
    found = report.comparison("rigid-joint", "B")
    assert np.sort(found.partners[1]).tolist() == list(range(COUNT))
    assert found.discrepancies[1] == pytest.approx(reduced[found.partners[1]] / complete - 1.0, rel=1e-6)
    assert found.rms[1] == pytest.approx(np.sqrt(np.mean((reduced / complete - 1.0) ** 2)), rel=1e-2)
    assert found.largest[1] == np.abs(found.discrepancies[1]).max()


def test_no_reduced_frequency_lies_below_the_model_of_its_own_kinematics(report):
    margins = {run.name: report.least_margin(run) for run in report.reductions}
    assert all(margin > -1e-8 for margin in margins.values()), margins
    assert report.comparison("averaged-interface", "B").margins.min() < -1e-2


def test_the_bound_holds_between_stations_with_contacts_in_place(tmp_path):
    """Interpolation is no subspace; whether it falls below is chance, but in place it cannot."""
    machine = gantry(tmp_path, travel=TRAVEL)
    poses = [{"x": 0.375}, {"x": 0.44, "phi": 0.3}]
    report = verify(machine, poses, models=["A"], count=4, in_place=True, reductions=reductions_named(AVERAGED))
    for run in report.reductions:
        assert run.in_place == pytest.approx(run.frequencies[:, :4], rel=2e-2)
        assert np.abs(run.in_place / run.frequencies[:, :4] - 1.0).max() > 1e-9
        assert report.least_margin_in_place(run) > -1e-8


def test_a_motion_that_nothing_holds_differs_by_nothing(tmp_path):
    """Of 0 Hz in all models: no division by it, in figures, tables, or JSON."""
    machine = gantry(tmp_path).replace({"joints.R.drive": None})
    report = verify(machine, [{}], models=["A"], count=4, reductions=reductions_named(AVERAGED))
    assert report.models[0].frequencies[0, 0] == 0.0
    for each in report.comparisons:
        assert each.discrepancies[0, 0] == each.margins[0, 0] == 0.0
        assert each.largest[0] < 1e-2
    json.dumps(as_dict(report), allow_nan=False)
    assert "nan" not in page([report])
    assert "| 1 | 0.00 | 0.00  +0.00  1.0000 | 0.00  +0.00  1.0000 |" in page([report])


def test_what_moves_freely_in_one_model_only_is_told():
    assert relative_difference(np.array([0.0, 3.0]), np.array([0.0, 2.0]), "a against A").tolist() == [0.0, 0.5]
    with pytest.raises(prs.PrsError, match="a against A: found 3 Hz where the complete model moves freely"):
        relative_difference(np.array([3.0]), np.array([0.0]), "a against A")


def test_the_same_kinematics_agree_and_one_node_a_joint_costs(report):
    assert report.comparison("rigid-interface", "B").largest.max() < 2e-3
    assert report.comparison("averaged-interface", "A").largest.max() < 2e-3
    assert report.comparison("averaged-interface", "A").mac_diagonal.min() > 0.9999
    assert report.comparison("rigid-joint", "B").largest.max() > 5e-3
    sizes = {run.name: run.size for run in report.reductions}
    assert sizes["rigid-joint"] == sizes["rigid-interface"] - 12
    assert report.shown == report.reductions[: len(REDUCTIONS)]


def test_joint_loaded_parts_are_as_good_at_fewer_coordinates(report):
    loaded, averaged = (
        next(run for run in report.shown if run.name == name) for name in ("joint-loaded", "averaged-interface")
    )
    assert loaded.size <= averaged.size
    assert report.comparison("joint-loaded", "A").largest.max() < 1e-2


def test_the_error_falls_with_the_number_of_modes(report):
    errors = [report.comparison(name, "A").largest.max() for name in report.curve]
    assert errors[0] > errors[1] > errors[2]
    sizes = [run.size for run in report.reductions if run.name in report.curve]
    assert np.diff(sizes).tolist() == [8, 24]


def test_the_report_is_told_in_tables_and_numbers(report):
    told = page([report], command="prs-model verify gantry")
    assert told.startswith("# gantry: verification\n\nMade by `prs-model verify gantry`.")
    for model in report.models:
        assert f"Discrepancies against {model.name}" in told
        assert f"| {model.frequencies[0, 0]:.2f} |" in told
    assert "Error against the number of coordinates" in told
    first, third = (f"{report.shown[0].frequencies[0, k]:.2f}" for k in (0, 2))
    assert f"| 1 | 100.00 | {first}  {float(first) - 100.0:+.2f} |" in told
    assert f"| 3 |  | {third} |" in told
    assert "| 2 | x 300 mm, y 25 mm, phi 28.648 deg |" in told
    rows = [line for line in told.splitlines() if line.startswith("|")]
    assert "nan" not in told
    assert len(rows) > 60
    plain = json.loads(json.dumps(as_dict(report), allow_nan=False))
    assert plain["pose_units"] == {"x": "m", "y": "m", "phi": "rad"}
    assert plain["models"][0]["frequencies_hz"] == report.models[0].frequencies.tolist()
    assert np.diagonal(plain["comparisons"][0]["mac"], axis1=1, axis2=2) == pytest.approx(
        np.array(plain["comparisons"][0]["mac_diagonal"]), abs=1e-6
    )


def test_stiffer_joints_are_those_of_the_description(machine):
    """The factor reaches interfaces, single laws and drives."""
    stiffer = with_joint_stiffness(with_joint_stiffness(machine, 2.0), 2.0)
    joints = machine.description.file.joints
    factor = {
        "joints.Y.drive.stiffness": 8.0e8,
        "joints.X.drive.stiffness": 4.0e8,
        "joints.R.drive.rotational_stiffness": 2e6,
    }
    laws = {f"joints.X.interfaces.{name}.stiffness": joints["X"].interfaces[0].stiffness for name in ("near", "far")}
    laws |= {f"joints.{name}.stiffness": joints[name].stiffness for name in "YR"}
    for path, law in laws.items():
        factor[path] = {
            axis: 4.0 * float(value) for axis in ("ux", "uy", "uz", "rx", "ry", "rz") if (value := getattr(law, axis))
        }
    assert stiffer.modes(8).frequencies == pytest.approx(machine.replace(factor).modes(8).frequencies, rel=1e-10)
    assert stiffer.modes(1).frequencies[0] > 1.2 * machine.modes(1).frequencies[0]


def test_poses_without_a_section_are_the_bounds_of_the_workspace(tmp_path):
    machine = gantry(tmp_path)
    poses = default_poses(machine)
    assert poses[0] == dict(machine.reference_pose)
    assert [tuple(pose.values()) for pose in poses[1:3]] == [(0.275, 0.025, 0.0), (0.475, 0.025, 0.0)]
    assert len(poses) == 7


def test_poses_of_a_grid_and_random_ones(machine):
    grid = grid_poses(machine, {"x": (0.3, 0.4), "y": (0.0, 0.1)})
    assert [(pose["x"], pose["y"]) for pose in grid] == [(0.3, 0.0), (0.3, 0.1), (0.4, 0.0), (0.4, 0.1)]
    assert all(pose["phi"] == 0.0 for pose in grid)
    some = random_poses(machine, 5, seed=1)
    assert some == random_poses(machine, 5, seed=1) != random_poses(machine, 5, seed=2)
    assert all(low <= pose[name] <= high for pose in some for name, (low, high) in machine.workspace.items())
    with pytest.raises(prs.UnknownNameError, match="known: x, y, phi"):
        grid_poses(machine, {"z": (0.1,)})


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("{poses: {z: [1.0]}}", "verification.poses.z: found 'z', expected a pose coordinate (x, y, phi)"),
        ("{poses: {x: []}}", "verification.poses.x: found an empty list"),
        ("{poses: {x: [a]}}", "expected a number"),
        ("{published: {paper: [0]}}", "expected a number above zero"),
    ],
)
def test_a_wrong_section_is_told(tmp_path, section, words):
    with pytest.raises(prs.DescriptionError) as told:
        gantry(tmp_path, f"verification: {section}\n")
    assert words in str(told.value)


def test_what_cannot_be_verified_is_told(tmp_path):
    with pytest.raises(prs.PrsError, match="come reduced, so that there is no complete order"):
        verify(prs.load_machine("hexapod"))
    machine = gantry(tmp_path)
    (tmp_path / "arm.msh").unlink()
    with pytest.raises(prs.PartFileError, match=r"arm\.msh: there is no such file, and the complete order needs it"):
        verify(machine)
    (tmp_path / "rebuild.py").touch()
    with pytest.raises(prs.PartFileError, match=r"make the part files with: python .*rebuild\.py"):
        verify(machine)


def test_wrong_arguments_are_told(machine):
    with pytest.raises(prs.UnknownNameError, match="unknown model 'C'; known: A, B"):
        verify(machine, models=["C"])
    with pytest.raises(prs.UnknownNameError, match="unknown reduction 'rigid'; known: rigid-joint"):
        reductions_named(["rigid"])
    with pytest.raises(prs.UnreachablePoseError, match="slide_x"):
        verify(machine, [{"x": 2.0}])
    with pytest.raises(prs.PrsError, match="found no reduction"):
        verify(machine, reductions=[])
    with pytest.raises(prs.PrsError, match="found no pose"):
        verify(machine, [])
