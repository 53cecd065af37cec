"""``prs-model verify``: tables, one JSON object, a folder of results, and one sentence where it cannot be done."""

import json
import re
import sys
from pathlib import Path

import pytest

from prs_model.cli import main
from tests.verification.gantry import gantry

SHORT = ["--models", "A", "--reductions", "averaged-interface", "-n", "3", "--no-cache"]
REBUILD = """import shutil, sys
assert sys.argv[1] == "--size", sys.argv
print("meshing at", sys.argv[2])
shutil.copy("{coarse}/arm.msh", "arm.msh")
"""


@pytest.fixture
def folder(tmp_path: Path) -> str:
    (tmp_path / "gantry").mkdir()
    return str(gantry(tmp_path / "gantry").description.folder)


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    status = main(arguments)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_tables_and_progress(folder, capsys):
    status, out, err = run(capsys, "verify", folder, *SHORT, "--pose", "x=0.4", "--pose", "phi=10deg", "y=50mm")
    assert status == 0, err
    assert "2    x 375 mm, y 50 mm, phi 10 deg" in out
    assert re.search(r"^A +complete order, interfaces averaged +1053 ", out, re.MULTILINE)
    assert re.search(r"^averaged-interface +averaged, one node an interface +66 .* A +\+", out, re.MULTILINE)
    assert "A: pose 2 of 2, x 375 mm, y 50 mm, phi 10 deg" in err


def test_json_is_one_object_and_joints_are_scaled(folder, capsys):
    grid = ["--grid", "x=300:400mm:2", "phi=0,30deg", "--random", "1", "--stiffness", "2"]
    with_json = ["--set", "joints.Y.drive.stiffness=1.0e8", "--json", "-q"]
    status, out, err = run(capsys, "verify", folder, *SHORT, *grid, *with_json)
    assert status == 0, err
    assert err == ""
    plain, stiffer = json.loads(out)["reports"]
    assert (plain["joint_stiffness"], stiffer["joint_stiffness"]) == (1.0, 2.0)
    assert len(plain["poses"]) == 5
    assert [round(pose["phi"], 6) for pose in plain["poses"][:4]] == [0.0, 0.523599, 0.0, 0.523599]
    assert [pose["x"] for pose in plain["poses"][:4]] == pytest.approx([0.3, 0.3, 0.4, 0.4])
    assert stiffer["models"][0]["frequencies_hz"][0][0] > 1.1 * plain["models"][0]["frequencies_hz"][0][0]


def test_results_are_written_with_pictures(folder, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    out = tmp_path / "out" / "gantry"
    assert main(["verify", folder, *SHORT, "-n", "2", "--pose", "x=0.4", "--curve", "-o", str(out), "-q"]) == 0
    names = {path.name for path in out.iterdir()}
    both = {f"{name}.{kind}" for name in ("discrepancies", "mac", "frequencies", "curve") for kind in ("svg", "png")}
    assert names == both | {"results.json", "results.md", "modes_A.png", "modes_averaged-interface.png"}
    told = (out / "results.md").read_text()
    assert all((out / name).stat().st_size > 1000 for name in re.findall(r"\]\(([^)]*)\)", told))
    assert json.loads((out / "results.json").read_text())[0]["machine"] == "gantry"
    assert f"written to {out / 'results.md'}" in capsys.readouterr().out


def test_a_quick_look_is_taken_at_a_copy(folder, tmp_path, capsys):
    """The folder's own rebuild.py makes the coarser meshes; the folder itself stays as it is."""
    from tests.meshes import box, write

    (tmp_path / "coarse").mkdir()
    write(box((0.3, 0.05, 0.05), (3, 1, 1), quadratic=False), tmp_path / "coarse" / "arm.msh")
    before = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
    Path(folder, "rebuild.py").write_text(REBUILD.format(coarse=tmp_path / "coarse"))
    status, out, err = run(capsys, "verify", folder, *SHORT, "--pose", "x=0.4", "--size", "2.5")
    assert status == 0, err
    assert "meshing at 2.5" in err
    assert re.search(r"^A +complete order, interfaces averaged +912 ", out, re.MULTILINE)
    assert before == {path.name: path.read_bytes() for path in Path(folder).iterdir() if path.name != "rebuild.py"}
    Path(folder, "rebuild.py").write_text("raise SystemExit('no gmsh here')")
    status, _, err = run(capsys, "verify", folder, *SHORT, "--size", "2")
    assert status == 1
    assert "rebuild.py --size 2 of gantry failed: no gmsh here" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["hexapod"], "come reduced, so that there is no complete order to verify against"),
        (["hexapod", "--size", "2"], "found no rebuild.py, so that there is no other mesh size"),
        (["GANTRY", "--models", "C"], "unknown model 'C'; known: A, B"),
        (["GANTRY", "--reductions", "rigid"], "unknown reduction 'rigid'; known: rigid-joint"),
        (["GANTRY", "--grid", "x=1:2"], "--grid x: found '1:2', expected a list such as"),
        (["GANTRY", "--grid", "x=1,two"], "--grid x: found unit 'two', expected one of m, cm, mm"),
        (["GANTRY", "--grid", "z=1"], "unknown pose coordinate 'z'; known: x, y, phi"),
        (["GANTRY", "--pose", "x=1deg"], "--pose x: found unit 'deg'"),
        (["GANTRY", "--pose", "x=1"], "slide_x"),
        (["GANTRY", "-o", "/proc/out"], "/proc/out: cannot be made"),
        (["GANTRY", "-o", sys.executable], "cannot be made"),
    ],
)
def test_wrong_input_is_one_clear_message_and_status_1(folder, capsys, arguments, words):
    status, out, err = run(
        capsys, "verify", *(folder if each == "GANTRY" else each for each in arguments), "--no-cache"
    )
    assert (status, out) == (1, "")
    assert words in err
    assert "Traceback" not in err
    assert len(err) < 600
