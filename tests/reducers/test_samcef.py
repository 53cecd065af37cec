"""SAMCEF: what a user can hand over, as text. No real export is public, so all of these files are made here."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_reducers.samcef.bacon import read_deck
from tests.reducers.writers.samcef import DECK, POINTS, fortran, matrices, table

MM = "mm-N-tonne-s"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    stiffness, mass = matrices()
    (tmp_path / "k.txt").write_text(fortran(stiffness))
    (tmp_path / "m.txt").write_text(fortran(mass))
    (tmp_path / "both.txt").write_text(
        f"RIGIDITE REDUITE\n 13 13\n{fortran(stiffness, 5)}\nMASSE REDUITE\n 13 13\n{fortran(mass, 5)}"
    )
    (tmp_path / "dofs.txt").write_text(table(places=False))
    (tmp_path / "dofs_xyz.txt").write_text(table(places=True))
    (tmp_path / "part.dat").write_text(DECK)
    return tmp_path


def expect(element: prs.SuperElement) -> None:
    """The part in SI: mass and places, the mode, and the stiffness between the nodes."""
    stiffness = matrices()[0]
    np.testing.assert_allclose(element.positions, POINTS / 1e3, atol=1e-15)
    np.testing.assert_allclose(element.stiffness[0, 0], stiffness[0, 0] * 1e3, rtol=1e-12)
    np.testing.assert_allclose(element.stiffness[3, 3], stiffness[3, 3] * 1e-3, rtol=1e-12)
    np.testing.assert_allclose(element.stiffness[12, 12], (2.0 * np.pi * 300.0) ** 2, rtol=1e-12)
    np.testing.assert_allclose(element.mass_properties().mass, 4.0, rtol=1e-9)
    assert element.n_modes == 1


def test_matrices_table_and_deck(folder: Path) -> None:
    element = prs.reduce("samcef", folder / "k.txt", mass="m.txt", dofs="dofs.txt", deck="part.dat")
    expect(element)
    assert element.nodes == ("11", "23")
    assert element.node_sets == {"BORE": ("11",), "TIP": ("23",)}


def test_both_matrices_in_one_file(folder: Path) -> None:
    expect(prs.reduce("samcef", folder / "both.txt", dofs="dofs_xyz.txt", units=MM))


def test_matrix_market_instead_of_dense_text(folder: Path) -> None:
    for name, matrix in zip(("k.mtx", "m.mtx"), matrices(), strict=True):
        values = "\n".join(f"{value:.17e}" for value in matrix.T.ravel())
        (folder / name).write_text(f"%%MatrixMarket matrix array real general\n13 13\n{values}\n")
    expect(prs.reduce("samcef", folder / "k.mtx", mass="m.mtx", dofs="dofs_xyz.txt", units=MM))


def test_titles_tell_which_matrix_is_which(folder: Path) -> None:
    text = (folder / "both.txt").read_text()
    first, second = text.split("\nMASSE")
    (folder / "both.txt").write_text(f"MASSE{second}\n{first}\n")
    expect(prs.reduce("samcef", folder / "both.txt", dofs="dofs_xyz.txt", units=MM))


def test_units_must_be_said_once_and_alike(folder: Path) -> None:
    options = {"mass": "m.txt", "dofs": "dofs.txt", "deck": "part.dat"}
    with pytest.raises(prs.PartFileError, match=r"\.UNIT says 'MM N T S', and 'units' something else"):
        prs.reduce("samcef", folder / "k.txt", units="m-N-kg-s", **options)
    (folder / "part.dat").write_text(DECK.replace("MM N T S", "INCH"))
    with pytest.raises(prs.PartFileError, match=r"\.UNIT 'INCH' is not understood: say 'units'"):
        prs.reduce("samcef", folder / "k.txt", **options)
    (folder / "part.dat").write_text(DECK.replace(".UNIT MM N T S\n", ""))
    with pytest.raises(prs.PartFileError, match="does not say its units"):
        prs.reduce("samcef", folder / "k.txt", **options)
    expect(prs.reduce("samcef", folder / "k.txt", units=MM, **options))
    (folder / "dofs.txt").write_text(f"# units: {MM}\n{table(places=False)}")
    expect(prs.reduce("samcef", folder / "k.txt", **options))
    (folder / "part.dat").write_text(DECK.replace("MM N T S", "SI"))
    with pytest.raises(prs.PartFileError, match=r"\.UNIT says 'SI', and dofs\.txt something else"):
        prs.reduce("samcef", folder / "k.txt", **options)


def test_exchanged_matrices_fail_the_gate(folder: Path) -> None:
    with pytest.raises(prs.PhysicsError):
        prs.reduce("samcef", folder / "m.txt", mass="k.txt", dofs="dofs_xyz.txt", units=MM)


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("k.txt", lambda text: "", "is empty"),
        ("k.txt", lambda text: text[:700], "ends within its last line"),
        ("k.txt", lambda text: text[: text.rindex("\n", 0, -1) + 1], "found 168 numbers .* expected 169: cut off"),
        ("k.txt", lambda text: text + " 1.0\n", "does not end with a line|found 1 numbers"),
        ("k.txt", lambda text: text.replace("D+", "D+x", 1), "expected a number"),
        ("k.txt", lambda text: "12 12\n" + text, "a matrix of size 12 12, expected 13"),
        ("k.txt", lambda text: "MASS\n" + text, "holds mass, expected the stiffness alone"),
        ("m.txt", lambda text: fortran(matrices()[1][np.tril_indices(13)]), "it may be one triangle"),
        ("m.txt", lambda text: text.replace(" 1.0000000000000000D+00", " NaN", 1), "not finite|no number|before line"),
        ("dofs.txt", lambda text: text.replace("12 23 rz", "12 11 rz"), "two rows are 11.rz"),
        ("dofs.txt", lambda text: text.replace("23", "24"), "1 of its nodes have no coordinates in part.dat: 24"),
        ("part.dat", lambda text: text.replace("X 300.", "X 3OO."), "line 7, .NOE: node 23"),
        ("part.dat", lambda text: text.replace("I 12 X", "I 11 X"), "line 6, .NOE: node 11 stands there twice"),
        ("part.dat", lambda text: text.replace("Y 100. ", ""), "X, Y and Z must all be there"),
        ("part.dat", lambda text: text.replace("I 23\n", "I 23 A 30\n"), "line 16, .SEL: found 'A'"),
        ("part.dat", lambda text: "nothing\n", "no BACON data file"),
    ],
)
def test_damaged_files_are_refused(folder: Path, name: str, change: Callable[[str], str], message: str) -> None:
    text = (folder / name).read_text()
    assert change(text) != text
    (folder / name).write_text(change(text))
    with pytest.raises(prs.PartFileError, match=message):
        prs.reduce("samcef", folder / "k.txt", mass="m.txt", dofs="dofs.txt", deck="part.dat", units=MM)


def test_table_and_deck_must_agree(folder: Path) -> None:
    (folder / "part.dat").write_text(DECK.replace("Y 100.", "Y 100.1"))
    with pytest.raises(prs.PartFileError, match=r"node 23 is 0\.1 away from where part\.dat has it"):
        prs.reduce("samcef", folder / "k.txt", mass="m.txt", dofs="dofs_xyz.txt", deck="part.dat")


def test_continued_lines_are_one(tmp_path: Path) -> None:
    path = tmp_path / "part.dat"
    nodes = ".NOE\n I 1 X .25 Y 0. $\n Z .3 ATT 1\n I 2 X 1. $ ! more\n\n Y 0. Z 0.\n"
    path.write_text(f"{nodes}.3DRO I 1\n.SEL GROUP 1 $\n NOEUD\n I 2\n")
    deck = read_deck(path)
    assert deck.nodes is not None
    np.testing.assert_array_equal(deck.nodes.coordinates, [[0.25, 0.0, 0.3], [1.0, 0.0, 0.0]])
    assert deck.groups == {"1": (2,)}


def test_other_spellings_of_public_writers(tmp_path: Path) -> None:
    """A plain table of nodes, GROUPE with a quoted name and one node a line, everything of a kind."""
    path = tmp_path / "part.dat"
    path.write_text(
        '.NOE\n 1 0.0E+00 0 0\n 2 1.0E+01 0 0\n.SEL GROUPE "one" NOEUDS\n I 1\n I 2\n'
        '.SEL GROUP 2 NOEUD TOUT NOM "all"\n'
    )
    deck = read_deck(path)
    assert deck.nodes is not None
    np.testing.assert_array_equal(deck.nodes.coordinates, [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    assert deck.groups == {"one": (1, 2), "all": (1, 2)}
    assert deck.units is None
