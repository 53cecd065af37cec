"""The command line as a user meets it: what is printed where, and the exit status."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.cli import main

GANTRY = Path(__file__).parents[1] / "description" / "small_machine"


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
        assert mode["character"].startswith(f"{mode['group']} {mode['motion']} (")
        assert mode["shares"][mode["group"]] == max(mode["shares"].values()) <= 1.0


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
        (["modes", "hexapod", "--pose", "z=1", "--pose", "z=2"], "given twice"),
        (["modes", "hexapod", "--json", "--pose", "x=1e308"], "found 1e+308 for x, expected a number between"),
        (["modes", 5000 * "x"], "x: cannot be read: "),
        (["modes", "hexapod", "--pose", "z=5m"], "z"),
        (["modes", "hexapod", "--set", "bodies.plattform.options.mass=2"], "platform"),
        (["modes", "hexapod", "--set", "bodies.platform.options.mass=-2"], "above zero"),
        (["modes", "hexapod", "--set", "bodies.platform=@none.yaml"], "none.yaml: cannot be read"),
        (
            ["validate", "hexapod", "--set", "bodies.platform={a: "],
            "--set bodies.platform: found '{a: ': not valid YAML",
        ),
        (["reducers", "sold"], "Did you mean 'solid'?"),
        (["modes", "hexapod", "--picture", "modes.bmp"], "expected one of .png"),
        (["modes", "hexapod", "--picture", 300 * "x" + ".png"], "x.png: cannot be written ("),
        (["modes", "hexapod", "--picture", "/proc/modes.png"], "/proc/modes.png: cannot be written ("),
        (["modes", "hexapod", "--picture", "no/such/folder/modes.png"], "cannot be written"),
        (["modes", ""], "unknown machine"),
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
    assert len(err) < 600


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["mode"],
        ["modes"],
        ["validate"],
        ["validate", "hexapod", "--schema"],
        ["modes", "hexapod", "-n", "0"],
        ["modes", "hexapod", "--pose", "z"],
    ],
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


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "--version") == (0, f"prs-model {prs.__version__}\n", "")


def test_a_pose_may_be_given_in_parts(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = run(capsys, "modes", "hexapod", "--json", "--pose", "z=89mm", "--pose", "rx=1deg", "x=1mm")
    pose = json.loads(out)["pose"]
    assert (pose["z"], pose["rx"], pose["x"]) == pytest.approx((0.089, np.pi / 180, 0.001))


def test_fewer_modes_than_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert "(all there are)" in run(capsys, "modes", "hexapod", "-n", "7")[1]
    assert "(all there are)" not in run(capsys, "modes", "hexapod", "-n", "6")[1]


def test_a_pose_outside_the_workspace_is_solved_with_a_warning(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(capsys, "modes", "hexapod", "-q", "--pose", "rx=360deg", "z=90mm")
    assert status == 0
    assert "hexapod at x 0 mm, y 0 mm, z 90 mm, rx 360 deg" in out
    assert err == "pose is outside the stated workspace: rx 360 deg, workspace -3 .. 3 deg\n"
    assert run(capsys, "modes", "hexapod", "--pose", "rx=3deg")[2] == ""


def gantry(folder: Path, old: str, new: str) -> str:
    shutil.copytree(GANTRY, folder, dirs_exist_ok=True)
    text = (folder / "machine.yaml").read_text()
    assert text.count(old) == 1
    (folder / "machine.yaml").write_text(text.replace(old, new))
    return str(folder)


def test_validate_gives_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    card = json.loads(run(capsys, "validate", "hexapod", "--json")[1])
    assert card["valid"] is True
    assert card["warnings"] == []
    assert card["bodies"]["platform"] == {"mass_kg": pytest.approx(1.0), "grounded": False}
    assert card["first_frequency_hz"] == pytest.approx(780.6, abs=0.1)


def test_validate_warns_of_an_axis_without_drive(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    law = "compliance: {ux: 1.0e-6, uy: 1.0e-6, rx: 0, ry: 0, rz: 0}\n"
    drive = "        drive: {kind: constant, stiffness: 2.0e5}\n"
    folder = gantry(tmp_path, law + drive, law)
    status, out, _ = run(capsys, "validate", folder)
    assert status == 0
    assert "warning: 1 of the modes have no frequency, ram moving freely; check for an axis without a drive" in out


def test_validate_warns_of_a_body_that_nothing_holds(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    loose = "  loose: {frame: bed, reducer: rigid, options: {mass: 1, inertia: {xx: 1.0e4, yy: 1.0e4, zz: 1.0e4}, "
    loose += "nodes: {a: [0, 0, 0]}}, interfaces: {a: {}}}\n"
    folder = gantry(tmp_path, "\njoints:\n", f"{loose}\njoints:\n")
    status, out, _ = run(capsys, "validate", folder, "--json")
    assert status == 0
    held, free = json.loads(out)["warnings"]
    assert held == "body 'loose' is held by no joint"
    assert free.startswith("6 of the modes have no frequency, loose moving freely")


APART = (
    "joint 'ram': its ends bridge.beam and ram.slide lie 20 mm apart; check 'at', the node positions, the body's frame"
)


def test_ends_that_lie_apart_are_warned_of_wherever_they_matter(capsys: pytest.CaptureFixture[str]) -> None:
    moved = ["--set", "bodies.ram.options.nodes.slide=[20, 0, 100]"]
    assert APART in run(capsys, "modes", str(GANTRY), *moved)[2]
    status, out, err = run(capsys, "validate", "-q", str(GANTRY), *moved)
    assert (status, err) == (0, "")
    assert f"warning: {APART}" in out
    assert "apart" not in run(capsys, "modes", str(GANTRY))[2]


def test_a_machine_warns_of_them_once(caplog: pytest.LogCaptureFixture) -> None:
    machine = prs.load_machine(GANTRY).replace({"bodies.ram.options.nodes.slide": (20.0, 0.0, 100.0)})
    for _ in range(2):
        machine.modes(1)
    assert [message.startswith(APART) for message in caplog.messages if "apart" in message] == [True]


def test_a_body_comes_from_a_file(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    platform = prs.load_machine("hexapod").description.raw["bodies"]["platform"]
    heavy = {**platform, "options": {**platform["options"], "mass": 4.0}}
    (tmp_path / "heavy.yaml").write_text(json.dumps(heavy))
    found = [
        json.loads(run(capsys, "modes", "hexapod", "--json", "--set", setting)[1])["frequencies_hz"]
        for setting in (f"bodies.platform=@{tmp_path / 'heavy.yaml'}", "bodies.platform.options.mass=4")
    ]
    assert found[0] == found[1]
    assert found[0] != prs.load_machine("hexapod").modes(6).frequencies.tolist()


def test_a_reducer_shows_what_it_takes(capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = run(capsys, "reducers", "beam", "--json")
    known = json.loads(out)
    kinds = {(each["name"], each["kind"], each["default"]) for each in known["options"]}
    assert kinds >= {
        ("nodes", "{name: [m, m, m]}", "required"),
        ("sections.<name>.kind", "round", "required"),
        ("sections.<name>.bore", "m", ""),
        ("sections.<name>.material.E", "N/m^2", "required"),
        ("members[].elements", "whole number", "8"),
    }
    assert (known["gives"], known["needs_source"], known["writes"]) == ("full", False, [])
    _, out, _ = run(capsys, "reducers", "nastran")
    for words in ("writes             .op4, .pch", "modal_basis: whether", "fixed-interface | other", "--units"):
        assert words in out
    assert "springs[].stiffness" in (shown := run(capsys, "reducers", "lumped")[1])
    assert "6 x 6 numbers" in shown
