"""``prs-model reduce``: one line from a part file to a checked element, with its figures, or one clear sentence."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.cli import main
from tests.meshes import box, write

STEEL = ["--set", "material.E=2.1e11", "--set", "material.nu=0.3", "--set", "material.density=7850"]
SOLID = ["--reducer", "solid", "--units", "mm-N-tonne-s", *STEEL]
ENDS = ["--interface", "root=x0", "--interface", "tip={set: x1, at: [0.4, 0.05, 0.04]}"]


@pytest.fixture
def block(tmp_path: Path) -> str:
    return str(write(box((0.4, 0.1, 0.08), (3, 1, 1)), tmp_path / "block.msh", scale=1000.0))


def test_a_mesh_becomes_a_stored_element(block, tmp_path, capsys):
    stored = tmp_path / "block.npz"
    assert main(["reduce", block, *SOLID, *ENDS, "--modes", "2", "-o", str(stored), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["mass_kg"] == pytest.approx(7850 * 0.4 * 0.1 * 0.08)
    assert said["size_m"] == pytest.approx([0.4, 0.1, 0.08])
    assert said["nodes_m"]["tip"] == [0.4, 0.05, 0.04]
    element = prs.SuperElement.load(stored)
    assert said["fixed_frequencies_hz"] == pytest.approx(np.sqrt(np.diag(element.stiffness)[12:]) / (2 * np.pi))
    assert all(each["figure"] <= each["limit"] for each in said["gate"])

    assert main(["reduce", str(stored), "--reducer", "npz"]) == 0
    shown = capsys.readouterr().out
    for words in ("25.12", "mass/kg", "free/Hz", "physics gate: passed", "tip", "(12 of nodes, 2 modal)"):
        assert words in shown


def test_clamped_sets_ground_the_part(block, capsys):
    assert main(["reduce", block, *SOLID, "--interface", "tip=x1", "--clamp", "x0", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["grounded"] is True
    assert said["mass_kg"] is None
    assert len(said["free_frequencies_hz"]) == 6


BEAM = """
nodes: {left: [0, 0, 0], right: [4.0e-3, 0, 0]}
sections: {bar: {kind: rectangle, y: 1.0e-4, z: 2.0e-4, material: {E: 2.1e11, nu: 0.3, density: 7850}}}
members: [{between: [left, right], section: bar}]
"""


def beam(folder: Path) -> list[str]:
    """The arguments of a small beam whose options are in files."""
    (folder / "beam.yaml").write_text(BEAM)
    options = [f"{name}=@{folder / name}.yaml" for name in ("nodes", "sections", "members")]
    for line in BEAM.strip().splitlines():
        name, value = line.split(": ", 1)
        (folder / f"{name}.yaml").write_text(value)
    words = ["--reducer", "beam", *(word for option in options for word in ("--set", option))]
    return [*words, "--interface", "a=left", "--interface", "b=right"]


def test_options_come_from_files_and_are_changed_after(tmp_path, capsys):
    """Words are nodes where they are no sets; a part of a few millimetres is shown to all its digits."""
    for height, more in ((2e-4, []), (4e-4, ["--set", "sections.bar.z=4.0e-4"])):
        assert main(["reduce", *beam(tmp_path), *more, "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["mass_kg"] == pytest.approx(7850 * 4e-3 * 1e-4 * height)
    assert main(["reduce", *beam(tmp_path), "-n", "2"]) == 0
    shown = capsys.readouterr().out
    assert re.search(r"^b +0\.004000+ +0\.000000+ +0\.000000+$", shown, re.MULTILINE)
    assert "size/m" in shown
    assert len(re.findall(r"\d\S*", next(line for line in shown.splitlines() if line.startswith("free/Hz")))) == 2
    assert "rigid interfaces raise them" in shown


def test_a_point_mass_is_shown_and_stored(tmp_path, capsys):
    """It has no frequencies; its figures come before its file."""
    stored = tmp_path / "point.npz"
    point = ["--reducer", "rigid", "--set", "mass=11600", "--set", "nodes={a: [0, 0, -1.0e-6]}", "-o", str(stored)]
    assert main(["reduce", *point]) == 0
    shown = capsys.readouterr().out
    rows = dict(re.findall(r"^(\S+(?: \S+)*) {2,}(.*)$", shown, re.MULTILINE))
    assert rows["mass/kg"] == "11600"
    assert rows["inertia/(kg m^2) x"] == rows["nodes within/m"] == "0  0  0"
    assert rows["nodes held/Hz"] == rows["free/Hz"] == "none"
    assert rows["a"].split() == ["0.00000000000", "0.00000000000", "-0.00000100000"]
    assert stored.exists()


def test_no_input_is_overwritten(block, capsys):
    assert main(["reduce", block, *SOLID, *ENDS, "-o", f"{block[:-4]}.npz"]) == 0
    stored = f"{block[:-4]}.npz"
    before = Path(stored).read_bytes()
    capsys.readouterr()
    assert main(["reduce", stored, "--reducer", "npz", "-o", stored]) == 1
    assert "the part is read from this file, which would be overwritten" in capsys.readouterr().err
    assert Path(stored).read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([*SOLID, *ENDS, "-o", "part.stl"], "expected one that a reducer writes: "),
        ([*SOLID, *ENDS, "-o", "nowhere/part.npz"], "there is no folder nowhere"),
        ([*SOLID, "--interface", "tip=x9"], "--interface tip: found 'x9', "),
        ([*SOLID, "--interface", "tip=[1, 900]"], "found node '900'"),
        ([*SOLID, "--interface", "tip="], "--interface tip: found '', expected a node set"),
        ([*SOLID, "--interface", "tip={box: "], "--interface tip: found '{box: ': not valid YAML"),
        ([*SOLID, "--interface", "tip=3,11"], "found '3,11'; several are written in brackets: 'tip=[3,11]'"),
        ([*SOLID, *ENDS, "--set", "materials=@none.yaml"], "none.yaml: cannot be read"),
        ([*SOLID, *ENDS, "-o", "part.npz", "--output-units", "mm-N-tonne-s"], "always in SI"),
        ([*SOLID, *ENDS, "-o", "part.op4", "--output-units", "foo"], "found 'foo', expected length-force-mass-time"),
        ([*SOLID, *ENDS, "--grounded"], "--grounded is said"),
        ([*SOLID, *ENDS, "--interface", "tip=x1"], "--interface tip: given twice"),
        ([*SOLID, *ENDS, "--set", "material=3"], "--set material: 'material' has entries already"),
        ([*SOLID[:2], *STEEL, *ENDS], "the file does not say its units: add --units"),
        (["--reducer", "solid", "--units", "mm-N-kg-s", *STEEL, *ENDS], "'mm-N-kg-s' is not consistent"),
        ([*SOLID, *ENDS, "--modes", "100000"], "too few for 100000 modes"),
        ([*SOLID, *ENDS, "--modes", "-1"], "--modes: "),
        ([*SOLID[:4], *ENDS, *STEEL[:4]], "prs-model: --set material.density: found nothing"),
        (["--reducer", "sold"], "Did you mean 'solid'"),
        (["--reducer", "npz"], "is no .npz file"),
    ],
)
def test_what_is_wrong_is_one_sentence(block, arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["reduce", block, *arguments]) == 1
    said = capsys.readouterr()
    assert words in said.err
    assert "Traceback" not in said.err
    assert not said.out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["block.msh"]
