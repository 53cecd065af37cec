"""Frequency responses as files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.response import FrequencyResponse


@pytest.fixture(scope="module")
def response() -> FrequencyResponse:
    return (
        prs.load_machine("hexapod").modes(6).frequency_response(np.linspace(500.0, 1500.0, 37), 0.02, "upper_1.joint")
    )


def test_csv_comes_back(response: FrequencyResponse, tmp_path: Path) -> None:
    response.save(tmp_path / "h.csv", ("u", "rw/v"))
    lines = (tmp_path / "h.csv").read_text().splitlines()
    assert lines[0] == "frequency [Hz],re u/u [m/N],im u/u [m/N],re rw/v [rad/N],im rw/v [rad/N]"
    table = np.loadtxt(lines[1:], delimiter=",")
    assert table[:, 0] == pytest.approx(response.frequencies, rel=1e-15)
    assert table[:, 3] + 1j * table[:, 4] == pytest.approx(response.curve("rw/v"), rel=1e-11)


def test_one_pair_may_be_named_alone(response: FrequencyResponse, tmp_path: Path) -> None:
    response.save(tmp_path / "h.csv", "u/v")
    assert (tmp_path / "h.csv").read_text().splitlines()[0] == "frequency [Hz],re u/v [m/N],im u/v [m/N]"


def test_universal_file_comes_back(response: FrequencyResponse, tmp_path: Path) -> None:
    pyuff = pytest.importorskip("pyuff")
    response.save(tmp_path / "h.uff")
    file = pyuff.UFF(str(tmp_path / "h.uff"))
    assert list(file.get_set_types()) == [164, 15, *[58] * 36]
    sets = file.read_sets()
    system = prs.load_machine("hexapod").assemble()
    names = ["output", *(f"{body}.{node}" for body, each in system.elements.items() for node in each.nodes)]
    upper = 1 + names.index("upper_1.joint")
    assert sets[1]["node_nums"] == [upper, 1]
    place = (
        system.output_placement.rotation.T
        @ np.array([system.ends.position("upper_1.joint"), system.output_placement.translation]).T
    )
    assert np.array([sets[1][axis] for axis in "xyz"]) == pytest.approx(place, rel=1e-5, abs=1e-9)
    assert (sets[0]["units_code"], sets[0]["length"], sets[0]["force"]) == (1, 1.0, 1.0)
    last = sets[-2]  # rw/rv
    ends = (last["rsp_node"], last["rsp_dir"], last["ref_node"], last["ref_dir"])
    assert (last["func_type"], *ends) == (4, upper, 6, 1, 5)
    assert (last["ordinate_len_unit_exp"], last["orddenom_force_unit_exp"], last["orddenom_len_unit_exp"]) == (0, 1, 1)
    assert (last["ordinate_spec_data_type"], last["orddenom_spec_data_type"]) == (8, 13)
    assert last["id1"].strip() == "receptance rw/rv [rad/(N m)]"
    assert last["x"] == pytest.approx(response.frequencies, rel=1e-5)
    assert last["data"] == pytest.approx(response.curve("rw/rv"), rel=1e-10)


def test_universal_files_keep_lines_apart(response: FrequencyResponse, tmp_path: Path) -> None:
    """Even lines are said by the first and the step; uneven ones have six digits, and are refused where these fail."""
    pyuff = pytest.importorskip("pyuff")
    modes = prs.load_machine("hexapod").modes(6)
    for lines, even in ((np.linspace(500.0, 1500.0, 41), 1), (np.geomspace(500.0, 1500.0, 41), 0)):
        modes.frequency_response(lines, 0.02).save(tmp_path / "h.uff", "u")
        found = pyuff.UFF(str(tmp_path / "h.uff")).read_sets()[-1]
        assert found["abscissa_spacing"] == even
        assert found["x"] == pytest.approx(lines, rel=1e-5)
    (tmp_path / "h.uff").unlink()
    for lines, words in (
        ([1000.001, 1000.002, 1001.0], "1000.001 and 1000.002 Hz apart"),
        ([1000.0], "two frequencies"),
    ):
        with pytest.raises(prs.PrsError, match=words):
            modes.frequency_response(lines, 0.02).save(tmp_path / "h.uff")
    assert not list(tmp_path.iterdir())


def test_pictures_are_drawn_whole(response: FrequencyResponse, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    response.save(tmp_path / "h.svg", ("u", "ru"), "title")
    text = (tmp_path / "h.svg").read_text()
    assert "receptance / (rad/(N m))" in text
    assert [each.name for each in tmp_path.iterdir()] == ["h.svg"]


def test_pictures_of_many_curves_and_any_title(response: FrequencyResponse, tmp_path: Path) -> None:
    """No mathematics in titles, round-off does not stretch the axis, and a long legend covers nothing."""
    pytest.importorskip("matplotlib")
    many = ["u", "v", "w", "u/v", "v/u", "u/w", "w/u"]
    tiny = replace(response, values=response.values * np.where(np.eye(6) > 0.0, 1.0, 1e-14))
    for k, each in enumerate((tiny, replace(tiny, values=0.0 * tiny.values))):
        each.save(tmp_path / f"{k}.svg", many, r"a $head of \\alpha")
    text = (tmp_path / "0.svg").read_text()
    assert "$head" in text
    assert "10^{-1" not in text  # decades of 1e-10 and below


@pytest.mark.parametrize(
    ("name", "pairs", "words"),
    [
        ("h.xls", None, "found a name ending in '.xls', expected one of .csv, .uff, .png"),
        ("no/h.csv", None, "cannot be written"),
        ("h.csv", ("x",), "unknown direction 'x'; known: u, v, w, ru, rv, rw"),
        ("h.csv", (1,), "direction: found 1, expected one such as 'u'"),
        *((f"h.{kind}", (), "pairs: found none, expected one at least") for kind in ("csv", "uff", "svg")),
    ],
)
def test_what_cannot_be_written_is_told(
    response: FrequencyResponse, tmp_path: Path, name: str, pairs: tuple[str, ...] | None, words: str
) -> None:
    with pytest.raises(prs.PrsError, match=words):
        response.save(tmp_path / name, pairs)
    assert not list(tmp_path.iterdir())
