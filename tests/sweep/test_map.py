"""``prs-model map``: what it prints and writes, and sentences for what cannot be meant."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.cli import main
from prs_model.cli.progress import line
from prs_model.sweep.drawn.panels import extreme

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
        (["--grid", "poses=1"], "unknown pose coordinate 'poses'"),
        (["--grid", "x=0:1mm:x"], "found '0:1mm:x', expected a list such as 10,20,30deg or a range first:last:count"),
        (["--grid", "x=0:1mm:1"], "found 1 values in '0:1mm:1', expected from 2 to 1,000,000"),
        (["--grid", "x=1mm:1mm:5"], "found '1mm:1mm:5' from a value to the same, expected two that differ"),
        (["--grid", "x=0:one:3"], "found unit 'one', expected one of m, cm, mm"),
        (["--grid", "x=0:1mm:1000000", "y=0:1mm:1000000"], "results of 1,000,000,000,000 poses take 99,000.0 GB"),
        ([*GRID, "-o", "nowhere/map.nc"], "nowhere/map.nc: cannot be written"),
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


@pytest.mark.parametrize("command", ["sweep.run._pieces", "sweep.files._table"])
def test_an_interruption_leaves_no_file(tmp_path, monkeypatch, capsys, command):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"prs_model.{command}", interrupted)
    assert main(["map", "hexapod", *GRID, "-n", "2", "-o", str(tmp_path / "map.csv")]) == 1
    assert "interrupted" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_long_table_is_written_in_slabs(tmp_path, monkeypatch):
    files = [tmp_path / "at_once.csv", tmp_path / "in_slabs.csv"]
    assert main(["map", "hexapod", *GRID, "-n", "2", "-o", str(files[0])]) == 0
    monkeypatch.setattr("prs_model.sweep.files._LINES", 4)
    assert main(["map", "hexapod", *GRID, "-n", "2", "-o", str(files[1])]) == 0
    at_once, in_slabs = (file.read_text() for file in files)
    assert at_once == in_slabs
    assert len(at_once.splitlines()) == 13


def test_identities_are_drawn_though_each_is_one_number_all_over(tmp_path):
    file = tmp_path / "identity.png"
    arguments = ["map", "hexapod", *GRID, "-n", "2", "--quantity", "identity", "--draw", "identity", "-o", str(file)]
    assert main(arguments) == 0
    picture = pytest.importorskip("PIL.Image").open(file).convert("RGB")
    shares = {colour: number / (picture.width * picture.height) for number, colour in picture.getcolors(2**24)}
    coloured = [colour for colour, share in shares.items() if share > 0.05 and len(set(colour)) > 1]
    assert len(coloured) == 2


def test_the_worst_of_poses_that_are_alike_is_the_first():
    values = np.array([[3.0, 2.0 + 1e-12], [2.0, np.nan]])
    assert extreme(values, -1) == (0, 1)
    assert extreme(values, 1) == (0, 0)


def test_an_address_without_a_scheduler_is_told(capsys):
    pytest.importorskip("distributed")
    assert main(["map", "hexapod", *GRID, "-n", "2", "--cluster", "udp:nowhere"]) == 1
    assert "cluster: found 'udp:nowhere', expected the address of a Dask scheduler" in capsys.readouterr().err


def test_a_grid_may_go_backwards(capsys):
    assert main(["map", "hexapod", "--grid", "x=2mm:-2mm:401", "-n", "1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert main(["map", "hexapod", "--grid", "x=-2mm:2mm:401", "-n", "1", "--json"]) == 0
    forward = json.loads(capsys.readouterr().out)
    assert found["modes"][0]["lowest_hz"] == pytest.approx(forward["modes"][0]["lowest_hz"], rel=2e-6)
    assert found["modes"][0]["median_hz"] == pytest.approx(forward["modes"][0]["median_hz"], rel=2e-6)


def test_the_bar_says_rate_and_time_left():
    assert line(1200, 4800, 600.0, "poses").endswith("25%  1,200 of 4,800 poses  600 a second  6 s left")
    assert line(1, 7201, 1.0, "poses").endswith("2 h 00 min left")
    assert line(8, 10, 0.0, "poses").endswith("8 of 10 poses  started")
