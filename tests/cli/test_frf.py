"""``prs-model frf`` as a user meets it."""

import json
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.response.band import band
from tests.cli.test_cli import run


def test_json_has_the_curves_of_the_library(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ("--range", "500:1500:21", "--damping", "0.02", "--direction", "u", "w/ru", "--from", "upper_2.slide")
    status, out, _ = run(capsys, "frf", "hexapod", "--json", "--pose", "z=89mm", "--quantity", "mobility", *arguments)
    outcome = json.loads(out)
    assert status == 0
    assert outcome["frequencies_hz"] == pytest.approx(np.linspace(500.0, 1500.0, 21))
    assert [(curve["response"], curve["excitation"], curve["unit"]) for curve in outcome["curves"]] == [
        ("u", "u", "m/s/N"),
        ("w", "ru", "m/s/(N m)"),
    ]
    machine = prs.load_machine("hexapod")
    system = machine.assemble(machine.configuration(z=0.089))
    expected = system.frf(outcome["frequencies_hz"], 0.02, at="upper_2.slide", quantity="mobility")[:, 2, 3]
    curve = outcome["curves"][1]
    assert np.array(curve["real"]) + 1j * np.array(curve["imag"]) == pytest.approx(expected, rel=1e-9)
    assert curve["largest"] == pytest.approx(np.abs(expected).max())
    assert np.array(outcome["static_compliance"]) == pytest.approx(system.static_compliance(at="upper_2.slide"))


def test_direct_and_modal_print_the_same_but_for_the_way(capsys: pytest.CaptureFixture[str]) -> None:
    _, modal, _ = run(capsys, "frf", "hexapod", "--range", "500:1500:21", "--damping", "0.02")
    _, direct, _ = run(capsys, "frf", "hexapod", "--range", "500:1500:21", "--damping", "0.02", "--direct")
    assert modal.replace("6 modes", "solved directly") == direct
    assert "platform along w, gives 100% of the compliance along w" in modal
    assert "N/um" in modal


def test_files_are_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("pyuff")
    files = [str(tmp_path / f"h.{suffix}") for suffix in ("csv", "uff", "png")]
    status, out, _ = run(capsys, "frf", "hexapod", "-n", "3", "-o", *files)
    assert status == 0
    assert all(f"written to {file}" in out for file in files)
    lines = np.loadtxt((tmp_path / "h.csv").read_text().splitlines()[1:], delimiter=",")[:, 0]
    modes = prs.load_machine("hexapod").modes(6)
    assert lines == pytest.approx(band(modes, np.zeros(6)))
    assert (tmp_path / "h.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(tmp_path.iterdir())) == 3


def test_the_output_may_be_named(capsys: pytest.CaptureFixture[str]) -> None:
    _, plain, _ = run(capsys, "frf", "hexapod", "--damping", "0.02")
    _, named, _ = run(capsys, "frf", "hexapod", "--damping", "0.02", "--from", "output", "--to", "output")
    assert plain == named


def test_without_damping_a_peak_has_no_end(capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever lines there are: the mode that is met is named."""
    status, out, _ = run(capsys, "frf", "hexapod", "--json", "--direction", "w", "ru", "--range", "10:1500:7")
    curves, modes = json.loads(out)["curves"], prs.load_machine("hexapod").modes(6)
    assert status == 0
    assert [curve["largest"] for curve in curves] == [None, None]
    assert [curve["largest_at_hz"] for curve in curves] == pytest.approx(modes.frequencies[[2, 3]])
    _, out, _ = run(capsys, "frf", "hexapod", "--direction", "w")
    assert "no end" in out
    assert "without damping peaks have no end; say it with --damping" in out
    _, out, _ = run(capsys, "frf", "hexapod", "--direction", "w", "--range", "10:100:7")
    assert "no end" not in out


def test_words_are_of_the_node_and_directions_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    damped = ("frf", "hexapod", "--damping", "0.02")
    _, out, _ = run(capsys, *damped, "--direction", "w", "w/u")
    assert "compliance along w" in out
    assert "compliance along u" not in out
    assert "w  P 100%" in out
    _, out, _ = run(capsys, *damped, "--from", "platform.joint_1", "--to", "platform.joint_1", "--direction", "u")
    assert "compliance along u" in out
    _, out, _ = run(capsys, *damped, "--from", "platform.joint_1")
    assert "of the compliance" not in out
    assert "dynamic stiffness" not in out


def test_dynamic_stiffness_and_least_real_part(capsys: pytest.CaptureFixture[str]) -> None:
    """Of one mode: 2 xi k, and -1 / (4 k xi (1 + xi)) at f sqrt(1 + 2 xi)."""
    _, out, _ = run(capsys, "frf", "hexapod", "--json", "--damping", "0.01", "--direction", "w")
    curve, modes = json.loads(out)["curves"][0], prs.load_machine("hexapod").modes(6)
    flexibility = modes.modal_flexibility()[2, 2]
    assert curve["least_real"] == pytest.approx(-flexibility / (4.0 * 0.01 * 1.01), rel=0.01)
    assert curve["least_real_at_hz"] == pytest.approx(modes.frequencies[2] * np.sqrt(1.02), rel=2e-3)
    _, out, _ = run(capsys, "frf", "hexapod", "--damping", "0.01", "--direction", "w")
    assert f"{2e-6 * 0.01 / flexibility:.3g}"[:3] in out


def test_a_joint_is_made_to_damp(capsys: pytest.CaptureFixture[str]) -> None:
    """Where the description has no entry for it; a few modes would then be wrong, and the system is solved."""
    status, out, _ = run(capsys, "frf", "hexapod", "--set", "damping.joints.P.viscous=2e-5", "-n", "3")
    assert status == 0
    assert "(solved directly; joint P damps)" in out
    status, _, err = run(capsys, "frf", "hexapod", "--set", "damping.joints.Q.viscous=2e-5")
    assert status == 1
    assert "found 'Q', expected a joint (U, P" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--range", "0:100:10"], "--range: found '0:100:10', expected first:last:count in Hz"),
        (["--range=-5:100:10"], "the first is '-5', not a frequency above zero"),
        (["--range", "10:x:10"], "the last is 'x', not a frequency above zero"),
        (["--range", "10:100"], "has 2 parts, not three"),
        (["--range", "100:10:5"], "the last, 10 Hz, is not above the first, 100 Hz"),
        (["--range", "10:100:1e99"], "the count is '1e99', not a whole number from 2 to 1000000"),
        (["--range", "10:100:1"], "the count is '1', not a whole number from 2 to 1000000"),
        (["--damping", "1.2"], "found 1.2, expected a ratio below 1"),
        (["--damping", "-0.1"], "found -0.1, expected zero or more"),
        (["--damping", "2.5%"], "--damping: found '2.5%', expected a ratio such as 0.025"),
        (["--from", "platform.X"], "unknown node of platform 'X'; known: M, joint_1"),
        (["--from", "platform"], "node: found 'platform', expected body.node, one of platform.M, platform.joint_1"),
        (["--to", "plattform.M"], "Did you mean 'platform'?"),
        (["--to", "upper.slide"], "There are several: upper_1, upper_2, upper_3, upper_4, upper_5, upper_6"),
        (["--direction", "x"], "unknown direction 'x'; known: u, v, w, ru, rv, rw"),
        (["-o", "no/such/folder/h.csv"], "no/such/folder/h.csv: cannot be written (No such file or directory)"),
        (["-o", "/proc/h.csv"], "/proc/h.csv: cannot be written"),
        (["-o", "h.xlsx"], "expected one of .csv, .uff, .png"),
        (["--pose", "z=5m"], "z"),
    ],
)
def test_wrong_input_is_one_clear_sentence(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    status, out, err = run(capsys, "frf", "hexapod", *arguments, "-q")
    assert status == 1
    assert out == ""
    assert words in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("arguments", [["--quantity", "stiffness"], ["-n", "0"], ["-n", "3", "--direct"]])
def test_wrong_usage_is_status_2(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> None:
    assert run(capsys, "frf", "hexapod", *arguments)[0] == 2
