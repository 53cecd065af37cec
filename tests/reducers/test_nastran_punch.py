"""DMIG punches and bulk data: real files, coordinate systems against pyyeti's, and what is refused by its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.units import Units
from prs_model.reduction import SuperElement
from prs_reducers import nastran
from tests.meshes import STEEL, box, steel, write
from tests.superelements import DATA, needs_data, reference

UNITS = "m-N-kg-s"
HEADER = "DMIG,{},0,6,2,0,,,{}\n"
BAR = (
    "$ a bar of 2 kg and 5 N/m between two points, along y; mode 7 is extra\n"
    "GRID,1,,0.,0.,0.\nGRID,2,,0.,3.,0.\n"
    + HEADER.format("KAAX", 3)
    + "DMIG,KAAX,1,2,,1,2,5.\n,2,2,-5.\nDMIG,KAAX,2,2,,2,2,5.\nDMIG,KAAX,7,0,,7,0,9.\n"
    + HEADER.format("MAAX", 3)
    + "DMIG,MAAX,1,2,,1,2,1.\nDMIG,MAAX,2,2,,2,2,1.0D0\nDMIG,MAAX,7,0,,7,0,1.+0\n"
)


def punch(folder: Path, text: str, **options: object) -> SuperElement:
    path = folder / "bar.pch"
    path.write_text(text)
    found = prs.read_part("nastran", path, units=UNITS, **options)
    assert isinstance(found, SuperElement)
    return found


@needs_data
@pytest.mark.parametrize("name", ["dmig", "dmig_sparse", "matrix_factory"])
def test_matrices_of_real_punches(name: str) -> None:
    expected = {each.upper(): tuple(shape) for each, shape in reference(f"dmig_punch/{name}").items()}
    assert nastran.matrices(DATA / "dmig_punch" / f"{name}.pch") == expected


@needs_data
@pytest.mark.parametrize("name", ["dmig", "dmig_sparse", "matrix_factory"])
def test_entries_of_real_punches_are_those_that_pyyeti_reads(name: str) -> None:
    bulk = pytest.importorskip("pyyeti.nastran.bulk")
    from prs_reducers.nastran.punch import punch_matrices

    path = DATA / "dmig_punch" / f"{name}.pch"
    ours = punch_matrices(path)
    for label, frame in bulk.rddmig(str(path)).items():
        matrix = ours[label.upper()]
        counted = matrix.form == 9
        for (row, column), value in matrix.entries.items():
            assert frame.loc[[row], [column[0] if counted else column]].to_numpy().item() == value
        twice = sum(row != column for row, column in matrix.entries) if matrix.form == 6 else 0
        stored = sum(value != 0.0 for value in matrix.entries.values())
        assert np.count_nonzero(frame.to_numpy()) == stored + twice


@needs_data
def test_a_punch_of_results_is_none() -> None:
    with pytest.raises(prs.PartFileError, match=r"fsi\.pch: line 8 .*perhaps a punch of results"):
        prs.read_part("nastran", DATA / "dmig_punch" / "fsi.pch", units=UNITS)


@needs_data
def test_a_punch_without_a_mass() -> None:
    """The stiffness is not offered for it."""
    with pytest.raises(
        prs.PartFileError, match=r"it has no mass matrix MAAX, only KAAX, PAX: export it too, .*'mass'$"
    ):
        prs.read_part("nastran", DATA / "dmig_punch" / "dmig_sparse.pch", units=UNITS)


@needs_data
def test_a_punch_without_places() -> None:
    with pytest.raises(prs.PartFileError, match=r"no GRID entries.* option 'grids'"):
        prs.read_part("nastran", DATA / "dmig_punch" / "dmig.pch", units=UNITS)


def test_a_bar(tmp_path: Path) -> None:
    element = punch(tmp_path, BAR)
    assert element.labels == ("1.uy", "2.uy", "mode 7")
    assert np.array_equal(element.stiffness, [[5.0, -5.0, 0.0], [-5.0, 5.0, 0.0], [0.0, 0.0, 9.0]])
    assert np.array_equal(element.mass, np.eye(3))
    assert np.array_equal(element.positions, [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0]])


def test_places_from_a_whole_deck(tmp_path: Path) -> None:
    """A deck has a case control before BEGIN BULK, which is no bulk data."""
    lines = BAR.splitlines(keepends=True)
    grids = [line for line in lines if line.startswith("GRID")]
    (tmp_path / "deck.bdf").write_text("SOL 103\nCEND\nTITLE = bar\nBEGIN BULK\n" + "".join(grids) + "ENDDATA\nx\n")
    element = punch(tmp_path, "".join(line for line in lines if line not in grids), grids="deck.bdf")
    assert np.array_equal(element.positions, punch(tmp_path, BAR).positions)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("2,2,-5.", "2,2,-5.x", r"line 5, DMIG: field 12 is '-5\.x', expected a finite number"),
        ("2,2,-5.", "2,8,-5.", r"entry at 2\.8, 1\.2, expected points with components 0 to 6"),
        (",2,2,-5.\n", ",2,2,-5.\n,2,2,-5.\n", r"two entries at 2\.2, 1\.2"),
        ("DMIG,KAAX,2,2,,2,2,5.\n", "DMIG,KAAX,2,2,,1,2,-5.,,+\n,2,2,5.\n", r"two entries at 1\.2, 2\.2"),
        (",2,2,-5.\n", ",2,2,-5.,,7,0,3.,,2,1,3.\n", "line 6: found '2' behind 8 fields"),
        ("DMIG,KAAX,0,6,2", "DMIG,KAAX,0,6,4", "matrix KAAX is complex"),
        ("DMIG,KAAX,0,6,2", "DMIG,KAAX,0,2,2", "matrix KAAX is rectangular"),
        ("DMIG,KAAX,0,6,2", "DMIG,KAAX,0,7,2", "form 7"),
        ("DMIG,KAAX,0,6,2,0,,,3", "DMIG,KAAX,0,6,2,0,,,2", "has 3 columns, but states 2"),
        ("DMIG,KAAX,0,6,2,0,,,3\n", "", "a column of KAAX, whose header .* is not before it"),
        ("DMIG,MAAX,0,6,2,0,,,3\n", "", "a column of MAAX"),
        ("DMIG,KAAX,1,2,,1,2,5.\n", "DMIG,KAAX,1,2\n", "first entry is blank: a line is missing"),
        ("GRID,2,", "GRID,22,", r"1 of its nodes have no coordinates in bar\.pch: 2"),
        ("GRID,2,,0.,3.,0.", "GRID,2,5,0.,3.,0.", "coordinate system 5 is not among"),
        ("GRID,2,,0.,3.,0.", "GRID,2,,0.,3.,0.\nGRID,2,,0.,4.,0.", "2 stands there twice"),
        ("GRID,2,", "SPOINT,8\nGRID,2,", r"row 7\.0 belongs to no SPOINT entry"),
        ("GRID,2,", "GRID,7,,0.,0.,0.\nGRID,2,", r"row 7\.0 belongs to no SPOINT entry"),
        ("GRID,2,", "$ prs-model units m-N\nGRID,2,", r"comment '\$ prs-model units m-N' is damaged: found 'm-N'"),
        ("GRID,2,", '$ prs-model point 2 = "a" "\nGRID,2,', r"comment '\$ prs-model point 2 = .*is damaged"),
        ("GRID,2,", "INCLUDE 'more.bdf'\nGRID,2,", "INCLUDE is not followed"),
        ("GRID,2,", "j\nGRID,2,", "found 'j', expected a bulk data entry"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert BAR.count(old) >= 1
    with pytest.raises(prs.PartFileError, match=said):
        punch(tmp_path, BAR.replace(old, new, 1))


def test_a_name_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(prs.PartFileError, match=r"no stiffness matrix KAA, only KAAX, MAAX: .* option 'stiffness'"):
        punch(tmp_path, BAR, stiffness="KAA")


def test_what_only_looks_like_something_else(tmp_path: Path) -> None:
    """A comment begins no bulk data, and the number of columns counts for form 9 only."""
    text = "$ after BEGIN BULK\n" + BAR.replace("0,6,2,0,,,3", "0,6,2,0,,,0")
    assert np.array_equal(punch(tmp_path, text).stiffness, punch(tmp_path, BAR).stiffness)


def test_a_continuation_of_another_width(tmp_path: Path) -> None:
    """As a flipped bit makes of ``*``: pyyeti would drop the line silently."""
    text = BAR.replace(
        "GRID,1,,0.,0.,0.\n",
        "GRID*                  1                              0.              0.\n+                     0.\n",
    )
    with pytest.raises(prs.PartFileError, match="line 3: a small-field line continues a large-field entry"):
        punch(tmp_path, text)


def test_coordinate_systems_are_those_of_pyyeti(tmp_path: Path) -> None:
    """Cylinders in spheres in a turned frame, for places and for motions."""
    bulk, n2p = pytest.importorskip("pyyeti.nastran.bulk"), pytest.importorskip("pyyeti.nastran.n2p")
    from prs_reducers.nastran.cards import read_cards
    from prs_reducers.nastran.geometry import grids_of, node_table, systems_of

    path = tmp_path / "systems.bdf"
    path.write_text(
        "CORD2C,30,20,1.,20.,30.,2.,50.,40.\n,1.5,70.,10.\n"
        "CORD2R,10,0,1.,2.,3.,2.,2.5,3.5\n,1.,5.,3.2\n"
        "CORD2S,20,10,.3,.2,.1,.4,.9,.2\n,1.3,.2,.1\n"
        "GRID,1,10,1.,2.,3.,30\nGRID,2,20,2.,35.,50.,20\nGRID,3,30,2.,35.,5.,10\nGRID,4,0,.1,.2,.3,30\n"
    )
    cards = read_cards(path)
    table = node_table(path, grids_of(cards), systems_of(cards))
    uset = bulk.bulk2uset(str(path))[0]
    assert table.frames is not None
    assert np.allclose(table.coordinates, uset.iloc[::6][["x", "y", "z"]].to_numpy(), rtol=1e-12)
    turns = n2p.rbgeom_uset(uset)[:, :3].reshape(4, 6, 3)[:, :3]
    assert np.allclose(table.frames.transpose(0, 2, 1), turns, atol=1e-12)


def test_a_system_that_refers_to_itself(tmp_path: Path) -> None:
    text = BAR.replace(
        "GRID,1,", "CORD2R,8,9,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,9,8,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,"
    )
    with pytest.raises(prs.PartFileError, match="coordinate system 8 refers to itself"):
        punch(tmp_path, text)


def test_a_whole_model_is_reduced_here(tmp_path: Path) -> None:
    """A block of steel as solid elements, and as PARAM,EXTOUT,DMIGPCH writes its matrices: the same super-element."""
    mesh = box((0.12, 0.04, 0.03), (2, 1, 1))
    model = steel(mesh)
    k, n = len(model.coordinates), model.size
    motions = np.zeros((k, 6, n))
    motions[model.dofs[:, 0], model.dofs[:, 1], np.arange(n)] = 1.0
    whole = SuperElement(
        stiffness=model.stiffness.toarray(),
        mass=model.mass.toarray(),
        nodes=tuple(str(node + 1) for node in range(k)),
        positions=model.coordinates,
        motions=motions,
    )
    nastran.NastranReducer().write(whole, tmp_path / "block.pch", Units())
    ends = {
        name: {"plane": {"point": (x, 0.0, 0.0), "normal": (1, 0, 0), "tolerance": 1e-6}}
        for name, x in (("base", 0.0), ("tip", 0.12))
    }
    found = prs.reduce("nastran", tmp_path / "block.pch", interfaces=ends, units=UNITS, modes=4, full=True)
    source = write(mesh, tmp_path / "block.msh")
    expected = prs.reduce("solid", source, interfaces=ends, units=UNITS, modes=4, material=STEEL)
    first = found.size - found.n_modes
    for name in ("stiffness", "mass"):
        ours, theirs = getattr(found, name), getattr(expected, name)
        assert np.allclose(ours[:first, :first], theirs[:first, :first], rtol=1e-7, atol=1e-8 * np.abs(theirs).max())
    assert np.diag(found.stiffness)[first:] == pytest.approx(np.diag(expected.stiffness)[first:], rel=1e-8)


def test_a_whole_model_that_is_not_said_to_be_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nastran, "MOST_ROWS", 1)
    text = "".join(line for line in BAR.splitlines(keepends=True) if ",7,0," not in line)
    with pytest.raises(
        prs.PartFileError, match="it has 2 rows and no modal coordinates, like a whole model: say 'full: "
    ):
        punch(tmp_path, text)
