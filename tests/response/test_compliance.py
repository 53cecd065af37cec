"""Static compliance, modal flexibility, weak modes."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from tests.response.two_masses import K1, K2, matrices, row
from tests.verification.gantry import gantry


def test_springs_in_a_row(tmp_path: Path) -> None:
    system = row(tmp_path).assemble()
    compliance = system.static_compliance()
    assert compliance[0, 0] == pytest.approx(1.0 / K1 + 1.0 / K2)
    assert system.static_compliance(to="one.end", at="two.end")[0, 0] == pytest.approx(1.0 / K1)
    assert np.count_nonzero(compliance) == 1  # all else is rigid


def test_flexibilities_of_all_modes_are_the_compliance(tmp_path: Path) -> None:
    modes = row(tmp_path).modes(2)
    assert modes.modal_flexibility()[:, 0].sum() == pytest.approx(1.0 / K1 + 1.0 / K2)
    assert modes.flexibility_shares().sum(axis=0) == pytest.approx([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    values, vectors = np.linalg.eig(np.linalg.inv(matrices()[0]) @ matrices()[1])
    mode = vectors[:, np.argmin(values)]
    expected = mode[1] ** 2 / (mode @ matrices()[0] @ mode) / values.min()
    assert modes.modal_flexibility()[0, 0] == pytest.approx(expected)


def test_shares_grow_towards_one_and_the_rest_is_told(tmp_path: Path) -> None:
    system = gantry(tmp_path).assemble()
    sums = [system.modes(count).flexibility_shares().sum(axis=0) for count in (2, 6, 20, system.size)]
    assert np.all(np.diff(sums, axis=0) > -1e-9)
    assert sums[0].min() < 0.5
    assert sums[-1] == pytest.approx(np.ones(6), rel=1e-8)


def test_the_weak_mode_is_named_with_its_reason(tmp_path: Path) -> None:
    """The arm's drive, made soft, lets the tip go along v, across the arm, and about w."""
    machine = gantry(tmp_path).replace({"joints.R.drive.rotational_stiffness": 1e3})
    weak = machine.modes(6).weak_modes()
    assert {each.direction for each in weak} == {"u", "v", "w", "ru", "rv", "rw"}
    across = next(each for each in weak if each.direction == "v")
    assert across.number == 1
    assert across.share > 0.9
    assert str(across) == (
        f"mode 1 ({across.frequency:.1f} Hz), arm along v, about w, gives 100% of the compliance along v; "
        "100% of its strain in joint R"
    )
    for axis, direction in enumerate(("u", "v", "w", "ru", "rv", "rw")):
        shares = machine.modes(6).flexibility_shares()[:, axis]
        named = [each.share for each in weak if each.direction == direction]
        assert named == pytest.approx(sorted(shares[shares >= 0.1], reverse=True) or [shares.max()])


def test_modes_of_equal_frequency_are_weak_together() -> None:
    """The hexapod's pairs give all of the compliance across its axis."""
    modes = prs.load_machine("hexapod").modes(6)
    along = {each.direction: each for each in modes.weak_modes(least=0.5)}
    shares = modes.flexibility_shares()
    assert (along["u"].numbers, along["u"].number) == ((1, 2), 1)
    assert (along["v"].numbers, along["v"].number) == ((1, 2), 2)
    assert along["u"].share == pytest.approx(shares[:2, 0].sum()) == pytest.approx(along["v"].share)
    assert str(along["u"]) == (
        "modes 1 and 2 (780.6 Hz), platform along u, together give 100% of the compliance along u; "
        "100% of their strain in joint P"
    )
    assert len(modes.weak_modes(least=1e-3)) > len(along)
    with pytest.raises(prs.PrsError, match="least: found 0, expected a share above 0 and below 1"):
        modes.weak_modes(least=0)


def test_weak_modes_of_any_node(tmp_path: Path) -> None:
    modes = row(tmp_path).modes(2)
    shares = modes.flexibility_shares("one.end")
    assert shares.sum(axis=0) == pytest.approx([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert modes.modal_flexibility("one.end")[:, 0].sum() == pytest.approx(1.0 / K1)
    assert [each.share for each in modes.weak_modes("one.end")] == pytest.approx(
        sorted(shares[shares >= 0.1], reverse=True)
    )


def test_where_the_compliance_comes_from(tmp_path: Path) -> None:
    """Springs in a row share it as their compliances; any joint has the share by which its factor changes it."""
    energy = row(tmp_path).assemble().static_energy()
    assert energy["spring"][0] == pytest.approx((1.0 / K2) / (1.0 / K1 + 1.0 / K2))
    assert energy["wall"][0] + energy["spring"][0] == pytest.approx(1.0)
    machine = gantry(tmp_path)
    energy, compliance = machine.assemble().static_energy(), np.diag(machine.assemble().static_compliance())
    assert sum(energy.values()) == pytest.approx(np.ones(6))
    up, down = (
        np.diag(machine.replace({"joints.Y.stiffness_factor": 1.0 + d}).assemble().static_compliance())
        for d in (1e-4, -1e-4)
    )
    assert (down - up) / 2e-4 / compliance == pytest.approx(energy["Y"], abs=1e-6)


def test_pose_and_axes_are_those_of_the_output(tmp_path: Path) -> None:
    """Turning the output frame turns the compliance: the same tensor in other axes."""
    machine = gantry(tmp_path)
    turned = machine.replace({"output.frame": "column"})
    pose = machine.configuration(phi=0.5)
    own, other = (each.assemble(pose).static_compliance() for each in (machine, turned))
    R = pose.placement("column").rotation.T @ pose.placement("arm").rotation
    X = np.kron(np.eye(2), R)
    assert other == pytest.approx(X @ own @ X.T, rel=1e-9, abs=1e-9 * np.abs(own).max())
    assert prs.load_machine("hexapod").assemble().static_compliance() == pytest.approx(
        prs.load_machine("hexapod").modes(2).static_compliance()
    )
