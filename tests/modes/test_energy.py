"""Energies: sums, groups, directions, and what they say of stiffness."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from tests.verification.gantry import gantry

MACHINES = ("gantry", "hexapod", "head_3prs")


@pytest.fixture(scope="module")
def modes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, prs.Modes]:
    machines = [gantry(tmp_path_factory.mktemp("gantry")), *map(prs.load_machine, MACHINES[1:])]
    return {name: machine.modes(6) for name, machine in zip(MACHINES, machines, strict=True)}


@pytest.mark.parametrize("name", MACHINES)
def test_shares_sum_to_one(modes: dict[str, prs.Modes], name: str) -> None:
    found = modes[name]
    for shares in (
        found.kinetic_energy(),
        found.strain_energy(),
        found.kinetic_energy_by_limb(),
        found.strain_energy_by_limb(),
    ):
        assert sum(shares.values()) == pytest.approx(np.ones(6), abs=1e-12)
        assert min(share.min() for share in shares.values()) >= -1e-12


@pytest.mark.parametrize("name", MACHINES)
def test_directions_of_a_joint_sum_to_its_share(modes: dict[str, prs.Modes], name: str) -> None:
    strain = modes[name].strain_energy()
    for joint, directions in modes[name].joint_strain_by_direction().items():
        assert directions.shape == (6, 6)
        assert directions.sum(axis=0) == pytest.approx(strain[joint], abs=1e-12)


def test_limbs_are_what_they_are_made_of(modes: dict[str, prs.Modes]) -> None:
    found = modes["hexapod"]
    limbs = found.kinetic_energy_by_limb()
    assert list(limbs) == ["platform", *(f"limb {number}" for number in range(1, 7))]
    kinetic = found.kinetic_energy()
    assert limbs["limb 4"] == pytest.approx(kinetic["lower_4"] + kinetic["upper_4"])
    strained = found.strain_energy_by_limb()
    assert strained["limb 4"] == pytest.approx(found.strain_energy()["P_4"])


def test_an_instance_of_its_own_stays_in_its_limb() -> None:
    machine = prs.load_machine("hexapod").replace(
        {"joints.P_2.drive.stiffness": 1e7, "bodies.upper_5.options.mass": 0.2}
    )
    assert list(machine.modes(6).strain_energy_by_limb()) == ["platform", *(f"limb {number}" for number in range(1, 7))]


def test_a_drive_is_strained_along_its_axis(modes: dict[str, prs.Modes]) -> None:
    """The struts' drives hold z, all else in them is rigid."""
    for directions in modes["hexapod"].joint_strain_by_direction().values():
        assert np.all(directions[[0, 1, 3, 4, 5]] == 0.0)


def test_a_joint_has_the_energy_by_which_its_stiffness_moves_the_eigenvalue(tmp_path: Path) -> None:
    """d lambda / d factor = phi^T K_j phi = lambda times the share, by central differences."""
    machine = gantry(tmp_path)
    modes = machine.modes(8)
    shares = modes.strain_energy()
    for joint in ("X", "Y", "R"):
        up, down = (
            machine.replace({f"joints.{joint}.stiffness_factor": 1.0 + change}).modes(8).eigenvalues
            for change in (1e-4, -1e-4)
        )
        assert (up - down) / 2e-4 == pytest.approx(modes.eigenvalues * shares[joint], rel=1e-5, abs=1e-7 * up[-1])


def test_one_instance_of_a_joint_likewise() -> None:
    """Of the hexapod's distinct frequencies: equal ones would turn into each other."""
    machine = prs.load_machine("hexapod")
    modes = machine.modes(6)
    up, down = (
        machine.replace({"joints.P_3.stiffness_factor": 1.0 + change}).modes(6).eigenvalues for change in (1e-4, -1e-4)
    )
    expected = modes.eigenvalues * modes.strain_energy()["P_3"]
    for mode in (2, 5):
        assert (up - down)[mode] / 2e-4 == pytest.approx(expected[mode], rel=1e-5)


def test_a_joint_named_as_a_body_is_kept_apart(tmp_path: Path) -> None:
    machine = gantry(tmp_path)
    text = (tmp_path / "machine.yaml").read_text().replace("  R:\n", "  arm:\n")
    (tmp_path / "machine.yaml").write_text(text)
    named, plain = prs.load_machine(tmp_path).modes(4).strain_energy(), machine.modes(4).strain_energy()
    assert named["joint arm"] == pytest.approx(plain["R"])
    assert named["arm"] == pytest.approx(plain["arm"])


def test_the_table_has_it_all(modes: dict[str, prs.Modes]) -> None:
    table = modes["gantry"].table()
    assert table.frequency.attrs["units"] == "Hz"
    assert table.kinetic.sum("body").values == pytest.approx(np.ones(6))
    assert table.strain.sel(part="R").values == pytest.approx(modes["gantry"].strain_energy()["R"])
    assert table.joint_strain.sel(joint="R").sum("axis").values == pytest.approx(table.strain.sel(part="R").values)
    assert table.flexibility.sel(mode=2, direction="v").item() == modes["gantry"].modal_flexibility()[1, 1]
    assert table.flexibility.unit.sel(direction="rw").item() == "rad/(N m)"
