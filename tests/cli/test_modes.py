"""``prs-model modes``: damping ratios beside the frequencies."""

import json

import numpy as np
import pytest

import prs_model as prs
from tests.cli.test_cli import run


def test_ratios_of_a_machine_whose_joints_damp(capsys: pytest.CaptureFixture[str]) -> None:
    """One loss factor on all that is elastic: s^2 = -omega^2 (1 + j eta), so sin(atan(eta) / 2) in every mode."""
    setting = ("--set", "damping.joints.P.loss_factor=0.06")
    _, out, _ = run(capsys, "modes", "hexapod", "--json", *setting)
    modes = json.loads(out)["modes"]
    assert [mode["damping_ratio"] for mode in modes] == pytest.approx([np.sin(np.arctan(0.06) / 2.0)] * 6)
    _, out, _ = run(capsys, "modes", "hexapod", *setting)
    assert out.count(" 3.00 % ") == 6
    assert "joint P damps" in out.splitlines()[0]


def test_ratios_as_given_and_none(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = run(capsys, "modes", "hexapod", "--json", "--damping", "0.01", "0.02")
    assert [mode["damping_ratio"] for mode in json.loads(out)["modes"]] == pytest.approx([0.01, *[0.02] * 5])
    _, out, _ = run(capsys, "modes", "hexapod")
    assert "; no damping)" in out.splitlines()[0]
    assert "damping" not in out.splitlines()[2]
    status, _, err = run(capsys, "modes", "hexapod", "--damping", "2")
    assert (status, "found 2, expected a ratio below 1" in err) == (1, True)


def test_ratios_belong_to_the_modes_they_stand_beside() -> None:
    """Only the drives damp: modes that strain them more have more, by their share of the strain energy."""
    modes = prs.load_machine("head_3prs").modes(8)
    ratios = modes.damping_ratios({"joints": {"P": {"loss_factor": 0.01}}})
    strain = sum(share for name, share in modes.strain_energy().items() if name.startswith("P_"))
    assert ratios == pytest.approx(0.005 * strain, rel=1e-2)
    assert np.argmax(ratios) == 4
