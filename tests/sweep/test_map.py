"""``prs-model map``: what it prints and writes, and sentences for what cannot be meant."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.cli import main
from prs_model.cli.progress import line

GRID = ["--grid", "x=-2mm:2mm:4", "z=89,90,120mm"]


def test_the_summary_says_where_each_mode_is_lowest(tmp_path, capsys):
    file = tmp_path / "map.nc"
    assert main(["map", "hexapod", *GRID, "-n", "2", "--json", "-o", str(file)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["poses"] == 12
    assert sum(each["poses"] for each in found["unreachable"]) == 4
    lowest = found["modes"][0]
    at = load_machine("hexapod").modes(1, **lowest["lowest_at"]).frequencies[0]
    assert lowest["lowest_hz"] == pytest.approx(at, rel=1e-6)
    assert lowest["lowest_hz"] <= lowest["median_hz"] <= lowest["highest_hz"]
    assert file.exists()


def test_the_table_names_what_is_out_of_reach(capsys):
    assert main(["map", "hexapod", *GRID, "-n", "2"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"\d poses: strut_\d above its upper limit 110 mm", out)
    assert "lowest/Hz" in out


def test_a_list_of_poses_comes_from_a_file(tmp_path, capsys):
    file = tmp_path / "poses.csv"
    file.write_text("rx [deg], z [mm]\n1.5, 90\n-1.5, 91\n")
    assert main(["map", "hexapod", "--poses", str(file), "-n", "1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["poses"] == 2
    here = {name: pytest.approx(value) for name, value in found["modes"][0]["highest_at"].items()}
    assert here["rx"] in (np.radians(1.5), np.radians(-1.5))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("rx [deg]\n", "found no pose, expected a header such as x [mm]"),
        ("nutation\n1\n", "nutation"),
        ("rx [mm]\n1\n", "found unit 'mm', expected one of rad, deg"),
        ("rx, z\n1\n", "poses.csv:2: found 1 values, expected 2"),
        ("rx\n1\none\n", "poses.csv:3: found 'one', expected a number"),
        ("rx,rx\n1,1\n", "found a coordinate twice"),
    ],
)
def test_wrong_lists_are_told_with_their_line(tmp_path, capsys, text, words):
    file = tmp_path / "poses.csv"
    file.write_text(text)
    assert main(["map", "hexapod", "--poses", str(file)]) == 1
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--grid", "nutation=1"], "unknown pose coordinate 'nutation'"),
        (["--grid", "poses=1"], "--grid poses: no pose coordinate"),
        ([*GRID, "--quantity", "frf_peak"], "band: found none"),
        ([*GRID, "--quantity", "stiffness"], "unknown quantity 'stiffness'"),
        ([*GRID, "--tolerance", "1"], "tolerance: found 1.0"),
        ([*GRID, "-o", "map.mat"], "found a name ending in '.mat'"),
        ([*GRID, "-o", "map.png", "--draw", "phase"], "unknown quantity to draw 'phase'"),
    ],
)
def test_wrong_arguments_are_told_before_the_work(tmp_path, monkeypatch, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    assert main(["map", "hexapod", *arguments]) == 1
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_bar_says_rate_and_time_left():
    assert line(1200, 4800, 600.0, "poses").endswith("25%  1,200 of 4,800 poses  600 a second  6 s left")
    assert line(1, 7201, 1.0, "poses").endswith("2 h 00 min left")
    assert line(8, 10, 0.0, "poses").endswith("8 of 10 poses  started")
