"""The command line as a user meets it: what is printed where, and the exit status."""

import json
from pathlib import Path

import pytest

from prs_model.cli import main


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    try:
        status = main(arguments)
    except SystemExit as leaving:
        status = int(leaving.code or 0)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_modes_as_json_is_one_object(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, _ = run(capsys, "modes", "hexapod", "-n", "6", "--json", "--pose", "z=89mm", "rx=1deg")
    outcome = json.loads(out)
    assert status == 0
    assert outcome["pose"]["z"] == pytest.approx(0.089)
    assert outcome["pose"]["rx"] == pytest.approx(0.0174532925)
    assert len(outcome["frequencies_hz"]) == 6
    for mode in outcome["modes"]:
        assert sum(mode["kinetic_energy"].values()) == pytest.approx(1.0, abs=1e-12)
        assert sum(mode["strain_energy"].values()) == pytest.approx(1.0, abs=1e-12)


def test_a_setting_changes_the_machine(capsys: pytest.CaptureFixture[str]) -> None:
    """Four times the stiffness of the only springs is twice every frequency."""
    _, plain, _ = run(capsys, "modes", "hexapod", "--json")
    _, stiffer, _ = run(capsys, "modes", "hexapod", "--json", "--set", "joints.P.drive.stiffness=8e7")
    for a, b in zip(json.loads(plain)["frequencies_hz"], json.loads(stiffer)["frequencies_hz"], strict=True):
        assert b == pytest.approx(2 * a, rel=1e-9)


def test_the_picture_is_written_whole(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    status, out, _ = run(capsys, "modes", "hexapod", "-n", "2", "--picture", str(tmp_path / "modes.png"))
    assert status == 0
    assert "Hz" in out
    assert (tmp_path / "modes.png").read_bytes().startswith(b"\x89PNG")
    assert [p.name for p in tmp_path.iterdir()] == ["modes.png"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["modes", "hexapot"], "Did you mean 'hexapod'?"),
        (["modes", "no/such/machine.yaml"], "no such file or folder"),
        (["modes", "hexapod", "--pose", "q=1"], "known: x, y, z, rx, ry, rz"),
        (["modes", "hexapod", "--pose", "z=1deg"], "found unit 'deg', expected one of"),
        (["modes", "hexapod", "--pose", "z=nan"], "expected a number"),
        (["modes", "hexapod", "--pose", "z=1", "z=2"], "given twice"),
        (["modes", "hexapod", "--pose", "z=5m"], "z"),
        (["modes", "hexapod", "--set", "bodies.plattform.options.mass=2"], "platform"),
        (["modes", "hexapod", "--set", "bodies.platform.options.mass=-2"], "above zero"),
        (["modes", "hexapod", "--picture", "modes.bmp"], "expected one of .png"),
        (["modes", "hexapod", "--picture", "no/such/folder/modes.png"], "cannot be written"),
        (["validate"], "name a machine"),
    ],
)
def test_wrong_input_is_one_clear_message_and_status_1(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    status, out, err = run(capsys, *arguments)
    assert status == 1
    assert out == ""
    assert words in err
    assert "Traceback" not in err
    assert "internal error" not in err


@pytest.mark.parametrize(
    "arguments", [[], ["mode"], ["modes"], ["modes", "hexapod", "-n", "0"], ["modes", "hexapod", "--pose", "z"]]
)
def test_wrong_usage_is_status_2(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> None:
    assert run(capsys, *arguments)[0] == 2


def test_listings_and_validate(capsys: pytest.CaptureFixture[str]) -> None:
    assert "hexapod" in run(capsys, "machines")[1]
    _, out, _ = run(capsys, "reducers", "--json")
    assert {"npz", "rigid", "solid"} <= {row["name"] for row in json.loads(out)["reducers"]}
    status, out, _ = run(capsys, "validate", "hexapod")
    assert status == 0
    assert "valid" in out
    _, out, _ = run(capsys, "validate", "--schema")
    assert "bodies" in json.loads(out)["properties"]
