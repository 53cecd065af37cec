"""``prs-model frf`` as a user meets it."""

import json
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
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
    assert len((tmp_path / "h.csv").read_text().splitlines()) == 1001
    assert (tmp_path / "h.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--range", "0:100:10"], "--range: found '0:100:10', expected first:last:count in Hz"),
        (["--range=-5:100:10"], "the first above zero"),
        (["--range", "10:100"], "expected first:last:count"),
        (["--range", "10:100:1e99"], "expected first:last:count"),
        (["--damping", "1.2"], "found 1.2, expected a ratio below 1"),
        (["--damping", "-0.1"], "found -0.1, expected zero or more"),
        (["--damping", "2.5%"], "--damping: found '2.5%', expected a ratio such as 0.025"),
        (["--from", "platform.X"], "unknown node of platform 'X'; known: M, joint_1"),
        (["--to", "plattform.M"], "unknown body 'plattform'"),
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
