"""OpenFAST's super-elements: the public files, and small ones made here."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.reduction.summary import summarize
from tests.reducers.writers.openfast import K, M, flex, guyan
from tests.superelements import DATA, needs_data, reference

SUMMARY = DATA / "openfast" / "FASTSum_5MW_OC3Mnpl.SD.sum.yaml"
EXT_PTFM = DATA / "openfast" / "FASTIn_ExtPtfm_SubSef.dat"


@needs_data
def test_subdyn_summary_meets_its_record() -> None:
    known = reference("openfast/SubDyn_OC3Mnpl")
    element = prs.reduce("openfast", SUMMARY, nodes={"tower": "interface"}, grounded=True)
    assert list(element.stiffness.shape) == known["size"]
    np.testing.assert_array_equal(np.diag(element.stiffness), known["K_diag"])
    np.testing.assert_array_equal(np.diag(element.mass), known["M_diag"])
    np.testing.assert_array_equal(element.positions[0], known["TP_point"])
    np.testing.assert_allclose(summarize(element).free, known["GY_recomputed"], rtol=1e-12)


@needs_data
def test_a_clamped_base_must_be_declared() -> None:
    with pytest.raises(prs.PhysicsError, match="say 'grounded: true'"):
        prs.reduce("openfast", SUMMARY, nodes={"tower": "interface"})


@needs_data
def test_rows_of_a_short_file_must_be_named() -> None:
    with pytest.raises(prs.PartFileError, match=r"has 3 rows, expected the six interface motions"):
        prs.read_part("openfast", EXT_PTFM)
    element = prs.read_part("openfast", EXT_PTFM, components=["ux", "uy", "uz"])
    assert isinstance(element, prs.SuperElement)
    assert element.labels == ("interface.ux", "interface.uy", "interface.uz")
    assert element.stiffness[2, 2] == 1.96653266e09
    assert element.mass[0, 1] == 5.07244708e-11


@needs_data
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text[: len(text) // 2], "cut off"),
        (
            lambda text: text.replace("3.530365E+08,   0.000000E+00,   0", "3.630365E+08,   0.000000E+00,   0", 1),
            "GY_freq",
        ),
        (lambda text: text.replace("9.517173E+04,   0", "9.517173E+05,   0", 1), "in brackets the file's GY_freq"),
        (lambda text: text.replace("KBBt: # 6 x 6", "KBBt: # 6 x 7"), "expected 6 rows and columns"),
        (lambda text: text.replace("1.140047E+11", "1.14?047E+11", 1), "expected a number"),
        (lambda text: text.replace("1.140047E+11", "         NaN", 1), "KBBt: found NaN, expected a finite number"),
        (lambda text: text.replace("6.141989E+00,", "nan,", 1), "GY_frequencies: found nan"),
        (lambda text: text.replace("KBBt: # 6 x 6", f"KBBt: # {5000 * '6'} x 6"), "has no entry 'KBBt"),
        (lambda text: text.replace("TP_point", "TP_pomnt", 1), "TP_point: expected the three coordinates"),
        (lambda text: text.replace("MBBt", "MBBx"), "has no entry 'MBBt"),
    ],
)
def test_damaged_summaries_are_refused(tmp_path: Path, change: Callable[[str], str], message: str) -> None:
    text = SUMMARY.read_text()
    assert change(text) != text
    (tmp_path / "part.sum.yaml").write_text(change(text))
    with pytest.raises(prs.PartFileError, match=message):
        prs.read_part("openfast", tmp_path / "part.sum.yaml")


def test_interface_motions_come_first_and_modes_after(tmp_path: Path) -> None:
    path = tmp_path / "se.dat"
    path.write_text(flex())
    element = prs.reduce("openfast", path, point=(0.0, 0.0, 10.0), nodes={"top": "interface"}, grounded=True)
    assert element.n_modes == 1
    np.testing.assert_array_equal(element.positions, [[0.0, 0.0, 10.0]])
    np.testing.assert_allclose(summarize(element).fixed, [3.0], rtol=1e-8)
    np.testing.assert_allclose(element.mass, M, rtol=1e-8)


def test_the_older_guyan_file(tmp_path: Path) -> None:
    path = tmp_path / "guyan.dat"
    path.write_text(guyan())
    element = prs.reduce("openfast", path, nodes={"top": "interface"}, grounded=True)
    np.testing.assert_allclose(element.stiffness, K[:6, :6], rtol=1e-8)
    np.testing.assert_allclose(element.mass, M[:6, :6], rtol=1e-8)
    path.write_text("\n".join(line for line in guyan().splitlines() if "1.00000000e+09" not in line) + "\n")
    with pytest.raises(prs.PartFileError, match="line 22: found 2 words in row 6 of the stiffness"):
        prs.read_part("openfast", path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "", "is empty"),
        (lambda text: text[:400], "cut off or shifted"),
        (lambda text: text[: text.index("!Damping")], "has no '!Damping Matrix'"),
        (lambda text: "\n".join(text.splitlines()[:-1]), "loads at 2 times, its heading says 3"),
        (lambda text: text.replace("!Dimension: 7", "!Dimension: 8", 1), "of dimension 7, the heading says 8"),
        (lambda text: text.replace("2.00000000e+08", "2.0000z000e+08", 1), "expected a number"),
        (lambda text: text.replace("file: 0.2", "file: inf"), "has no '!Loading' with time increment and total time"),
        (lambda text: text.replace("!Dimension: 7", f"!Dimension: {5000 * '7'}"), "cut off or shifted"),
        (lambda text: text.replace("!Stiffness", "!Mass"), "a second mass matrix"),
        (lambda text: text.replace("Flex 5", "Flux 5"), "is neither an ExtPtfm file"),
        (lambda text: "%!PS\0" + text, "binary"),
    ],
)
def test_damaged_texts_are_refused(tmp_path: Path, change: Callable[[str], str], message: str) -> None:
    path = tmp_path / "se.dat"
    path.write_text(change(flex()))
    with pytest.raises(prs.PartFileError, match=message):
        prs.read_part("openfast", path)


def test_units_other_than_si_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "se.dat"
    path.write_text(flex())
    with pytest.raises(prs.PartFileError, match="takes SI only"):
        prs.read_part("openfast", path, units="mm-N-tonne-s")
