"""``prs-model reduce``: one line from a part file to a checked element, with its figures, or one clear sentence."""

import json
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


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([*SOLID, *ENDS, "-o", "part.stl"], "expected one that a reducer writes: "),
        ([*SOLID, *ENDS, "-o", "nowhere/part.npz"], "there is no folder nowhere"),
        ([*SOLID, "--interface", "tip=x9"], "found node set 'x9', expected one of"),
        ([*SOLID, "--interface", "tip=[1, 900]"], "found node '900'"),
        ([*SOLID, "--interface", "tip="], "--interface tip: found '', expected a node set"),
        ([*SOLID, *ENDS, "--interface", "tip=x1"], "--interface tip: given twice"),
        ([*SOLID, *ENDS, "--set", "material=3"], "--set material: 'material' has a value already"),
        ([*SOLID[:2], *STEEL, *ENDS], "the file does not say its units: add 'units'"),
        (["--reducer", "solid", "--units", "mm-N-kg-s", *STEEL, *ENDS], "'mm-N-kg-s' is not consistent"),
        ([*SOLID, *ENDS, "--modes", "100000"], "too few for 100000 modes"),
        ([*SOLID, *ENDS, "--modes", "-1"], "modes: "),
        ([*SOLID[:4], *ENDS, *STEEL[:4]], "options.material.density: found nothing"),
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
