"""What stands in the folder of a report: the library's numbers, and nothing that needs a network."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.report.sources import entries
from tests.response.two_masses import row


def table(path: Path) -> list[list[str]]:
    return list(csv.reader(path.read_text(encoding="utf-8").splitlines()))


def test_tables_are_those_of_the_library(hexapod: Path) -> None:
    modes = prs.load_machine("hexapod").modes(8, z=0.0935)
    folder = hexapod / "pose_2"
    rows = table(folder / "modes.csv")
    assert [float(row[1]) for row in rows[1:]] == pytest.approx(modes.frequencies)
    assert [float(row[2]) for row in rows[1:]] == [0.02] * 6
    compliance = np.array([row[1:7] for row in table(folder / "compliance.csv")[1:]], dtype=float)
    assert compliance == pytest.approx(modes.static_compliance())
    energies = np.array([row[1:] for row in table(folder / "strain_energy.csv")[1:]], dtype=float)
    assert energies.sum(axis=0) == pytest.approx(np.ones(6))
    frf = np.array(table(folder / "frf.csv")[1:], dtype=float)
    assert frf[:, 1] + 1j * frf[:, 2] == pytest.approx(modes.frf(frf[:, 0], 0.02)[:, 0, 0])


def test_results_hold_all_poses(hexapod: Path) -> None:
    results = json.loads((hexapod / "results.json").read_text(encoding="utf-8"))
    assert [pose["pose"]["z"] for pose in results["poses"]] == pytest.approx([0.09, 0.0935])
    first = prs.load_machine("hexapod").modes(8)
    assert results["poses"][0]["frequencies_hz"] == pytest.approx(first.frequencies)
    assert results["poses"][0]["weak_modes"] == [str(each) for each in first.weak_modes()]


def test_every_number_has_its_unit(hexapod: Path) -> None:
    results = json.loads((hexapod / "results.json").read_text(encoding="utf-8"))
    units = results["units"]
    assert units["pose"] == {"x": "m", "y": "m", "z": "m", "rx": "rad", "ry": "rad", "rz": "rad"}
    assert units["static_compliance"][3] == ["rad/N"] * 3 + ["rad/(N m)"] * 3
    assert results["poses"][0]["damping"] == {"modal": 0.02, "joints": {}}
    heads = {path.name: table(path)[0] for path in (hexapod / "pose_1").glob("*.csv")}
    assert heads["compliance.csv"][1] == "by force along u [per N]"
    assert heads["compliance.csv"][6] == "by moment about w [per N m]"
    assert [row[0] for row in table(hexapod / "pose_1" / "compliance.csv")[1:]][2:4] == ["along w [m]", "about u [rad]"]
    for name in ("kinetic_energy.csv", "strain_energy.csv", "joint_strain_energy.csv", "mac.csv"):
        assert heads[name][-1].endswith("in mode 6 [-]" if "energy" in name else "with mode 6 [-]")


def test_what_others_found_stands_beside(head: Path, hexapod: Path) -> None:
    text = (head / "report.html").read_text(encoding="utf-8")
    assert "Beside published frequencies, at nutation 0 deg" in text
    assert "--set reduction.method=craig-bampton" in text  # why the two differ
    modes = prs.load_machine("head_3prs").modes(8)
    sums = 100.0 * modes.flexibility_shares()[[5, 6], :2].sum(axis=0)
    for published, most in (("72.95", f"{sums[0]:.1f} % by 6 and 7"), ("75.45", f"{sums[1]:.1f} % by 6 and 7")):
        assert re.search(rf"<td class=\"n\">{published}</td>.*{most}</td>", text)
    assert "tdehaeze/stewart-simscape" in (hexapod / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["head", "hexapod"])
def test_page_is_alone_and_light(name: str, request: pytest.FixtureRequest) -> None:
    page = request.getfixturevalue(name) / "report.html"
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < 10e6
    assert not re.findall(r"(?:src|href)=\"(?:https?:)?//", text)
    for link in re.findall(r"href=\"([^\"#:]+)\"", text):
        assert (page.parent / link).is_file(), link
    images = re.findall(r"<img [^>]*>", text)
    assert images
    assert all(re.search(r"alt=\"[^\"]{20,}\"", image) for image in images)


def test_every_number_of_a_joint_has_its_source() -> None:
    found = {entry.place: entry for entry in entries(prs.load_machine("hexapod").description)}
    drive = found["joints.P.drive.stiffness"]
    assert (drive.value, drive.unit, drive.source) == ("2e+07", "N/m", "paper")
    assert found["joints.S.stages.1"].value == "rigid"
    assert found["bodies.platform.options.mass"].unit == "kg"
    assert found["bodies.platform.options.centre"].source == "assumed"
    law = {entry.place: entry for entry in entries(prs.load_machine("head_3prs").description)}
    assert law["joints.seat.stiffness.ux"].unit == "N/mm"
    assert law["joints.seat.stiffness.rz"].source == law["joints.seat.stiffness.ux"].source != ""


def test_warnings_are_told(hexapod: Path) -> None:
    text = (hexapod / "report.html").read_text(encoding="utf-8")
    assert "outside the stated workspace: z 93.5 mm, workspace 87 .. 93 mm" in text


def test_machine_that_can_move_freely(tmp_path: Path) -> None:
    """No compliance, no response, no strain energy; a sentence in their place, and the shapes of the free motions."""
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    machine = prs.load_machine("hexapod").replace({"joints.P.drive": None})
    files = prs.write_report(machine, tmp_path / "report", damping=0.02)
    names = {path.name for path in files}
    assert "mode_6.glb" in names
    assert names.isdisjoint({"compliance.csv", "flexibility.svg", "frf.csv", "frf.svg"})
    assert "The machine can move without straining anything" in files[0].read_text(encoding="utf-8")


def test_a_smaller_report_leaves_nothing_of_a_larger_one(tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    machine = prs.load_machine("hexapod")
    prs.write_report(machine, tmp_path, [{}, {"z": 0.091}], 3)
    (tmp_path / "pose_2" / "my notes.txt").write_text("keep", encoding="utf-8")
    (tmp_path / "pose_1" / "other.csv").write_text("keep", encoding="utf-8")
    files = prs.write_report(machine, tmp_path, [{}], 2)
    others = {tmp_path / "pose_2" / "my notes.txt", tmp_path / "pose_1" / "other.csv"}
    assert {path for path in tmp_path.rglob("*") if path.is_file()} == {*files, *others}


@pytest.mark.parametrize("place", ["prs_model.report.run.page", "prs_model.report.run.write_card"])
def test_an_interrupted_report_leaves_the_last_one(place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    machine = prs.load_machine("hexapod")
    prs.write_report(machine, tmp_path, [{"z": 0.091}], 1)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(place, interrupted)
    with pytest.raises(KeyboardInterrupt):
        prs.write_report(machine, tmp_path, [{}, {}], 2)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_dir()) == ["pose_1"]


def test_a_page_too_large_for_a_mail_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("prs_model.report.run._LARGEST", 100_000)
    with pytest.raises(prs.PrsError, match=r"would take 0\.\d MB \(poses: 1, modes: 2\), expected 10 MB at most"):
        prs.write_report(prs.load_machine("hexapod"), tmp_path, count=2)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("folder", "words"),
    [
        ("", "found '' as a folder, expected the name of one"),
        (None, "found None as a folder"),
        ("taken", r"taken/pose_1: found a file, where the report has a folder"),
        ("filled", r"filled/report.html: found a folder, where the report has a file"),
    ],
)
def test_a_folder_that_cannot_hold_it(
    folder: str | None, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "filled" / "report.html").mkdir(parents=True)
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "pose_1").write_text("mine", encoding="utf-8")
    with pytest.raises(prs.PrsError, match=words):
        prs.write_report(prs.load_machine("hexapod"), folder)  # type: ignore[arg-type]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["filled", "taken"]


@pytest.mark.parametrize(
    ("poses", "damping", "words"),
    [
        ([], None, "found no pose"),
        ({"z": 0.09}, None, r"poses: found {'z': 0.09}, expected a list of them"),
        ([0.09], None, r"poses: found \[0.09\], expected a list of them"),
        ([{}], 1.5, "found 1.5, expected a ratio below 1"),
        ([{"height": 1.0}], None, "height"),
        ([{"z": 9.0}], None, "z"),
    ],
)
def test_wrong_input_makes_no_page(poses: list[dict[str, float]], damping: float, words: str, tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    with pytest.raises(prs.PrsError, match=words):
        prs.write_report(prs.load_machine("hexapod"), tmp_path / "new", poses, damping=damping)
    assert not list(tmp_path.rglob("*.html"))


def test_a_machine_that_floats_has_a_report(tmp_path: Path) -> None:
    """Its rigid-body modes have no damping ratio, which JSON cannot say as a number."""
    pytest.importorskip("matplotlib")
    (tmp_path / "row").mkdir()
    machine = row(tmp_path / "row", "rayleigh: {alpha: 2.0, beta: 1.0e-4}", ground=False)
    prs.write_report(machine, tmp_path / "report")
    results = json.loads((tmp_path / "report" / "results.json").read_text(encoding="utf-8"))
    ratios = results["poses"][0]["damping_ratios"]
    assert ratios[:3] == [None] * 3
    assert 0.0 < ratios[3] < 1.0


def test_the_map_says_where_each_mode_is_lowest(hexapod: Path, head: Path) -> None:
    page = (hexapod / "report.html").read_text(encoding="utf-8")
    words = page.split('<section id="map">')[1].split("</section>")[0]
    assert "2821 poses, 0 of them out of reach. Lowest: mode 1 " in words
    assert {"map.png", "map.svg", "map.csv"} <= {path.name for path in hexapod.iterdir()}
    assert '<section id="map">' not in (head / "report.html").read_text(encoding="utf-8")
