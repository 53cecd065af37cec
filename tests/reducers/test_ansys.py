"""ANSYS matrices: the public .full file of a rotor, and exports made here from its matrices."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scipy.io import hb_write
from scipy.sparse import csc_array, tril

import prs_model as prs
from prs_model.arrays import FloatArray, IntArray
from prs_model.description.units import Units
from prs_model.part_files import LabelledMatrices
from prs_model.reduction.summary import summarize
from prs_reducers.ansys import load_full
from prs_reducers.ansys.node_list import read_nodes, rotated_axes
from tests.reducers.writers.ansys import FOOT, ROTOR, back, listing, mapping, market, places_of
from tests.superelements import needs_data, reference

EXAMPLES = Path(reader.origin or "").parent / "examples" if (reader := find_spec("ansys.mapdl.reader")) else Path()
CLAMPED = EXAMPLES / "file.full"


@pytest.fixture(scope="module")
def rotor() -> LabelledMatrices:
    return load_full(ROTOR)


@pytest.fixture(scope="module")
def places(rotor: LabelledMatrices) -> tuple[IntArray, FloatArray]:
    return places_of(rotor)


@pytest.fixture
def export(tmp_path: Path, rotor: LabelledMatrices, places: tuple[IntArray, FloatArray]) -> Path:
    (tmp_path / "k.txt").write_text(market(rotor.stiffness.toarray()))
    (tmp_path / "m.txt").write_text(market(rotor.mass.toarray()))
    (tmp_path / "map.txt").write_text(back(places[0]))
    (tmp_path / "nodes.txt").write_text(listing(*places))
    return tmp_path


OPTIONS = {"mass": "m.txt", "map": "map.txt", "coordinates": "nodes.txt"}
PAGE = (Path(__file__).parents[2] / "docs" / "part-files.md").read_text()


@needs_data
def test_full_file_meets_its_record(rotor: LabelledMatrices) -> None:
    known = reference("ansys/sparse.full")
    order = np.lexsort((rotor.components, rotor.nodes))
    assert np.column_stack([rotor.nodes, rotor.components])[order][:4].tolist() == known["dof_ref_first4"]
    assert list(rotor.stiffness.shape) == known["size"]
    model = prs.FiniteElementModel(
        stiffness=rotor.stiffness,
        mass=rotor.mass,
        coordinates=np.zeros((115, 3)),
        dofs=np.column_stack([rotor.nodes - 1, rotor.components]),
    )
    np.testing.assert_allclose(model.frequencies(14)[6:], known["freq_hz_first"][6:], rtol=1e-7)


@needs_data
def test_rotor_weighs_what_the_same_rotor_weighs_in_abaqus(export: Path) -> None:
    """The file with a node list is a part: mass and mass centre are those of the same mesh in another solver."""
    known = reference("abaqus/rotorDisc")
    model = prs.read_part("ansys", ROTOR, units="m-N-kg-s", coordinates=str(export / "nodes.txt"))
    body = model.mass_properties()
    np.testing.assert_allclose(body.mass, known["mass_xyz"][0], rtol=1e-6)
    np.testing.assert_allclose(body.centre, known["cg"], atol=1e-6)


@needs_data
def test_exports_are_the_same_part_as_the_full_file(export: Path, rotor: LabelledMatrices) -> None:
    element = prs.reduce("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS, interfaces=FOOT)
    model = prs.read_part("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS)
    assert element.check()
    np.testing.assert_allclose(model.stiffness.toarray(), rotor.stiffness.toarray(), rtol=1e-14)
    np.testing.assert_allclose(
        model.frequencies(14)[6:], reference("ansys/sparse.full")["freq_hz_first"][6:], rtol=1e-7
    )


@needs_data
@pytest.mark.parametrize("kind", ["RSA", "RUA"])
def test_harwell_boeing_with_its_mapping(export: Path, rotor: LabelledMatrices, kind: str) -> None:
    for name, matrix in (("k.hb", rotor.stiffness), ("m.hb", rotor.mass)):
        hb_write(export / name, csc_array(tril(matrix) if kind == "RSA" else matrix))
        (export / name).write_text((export / name).read_text().replace("RUA", kind))
    (export / "k.mapping").write_text(mapping(rotor.nodes, rotor.components))
    options = {**OPTIONS, "mass": "m.hb", "map": "k.mapping"}
    model = prs.read_part("ansys", export / "k.hb", units="m-N-kg-s", **options)
    np.testing.assert_allclose(model.stiffness.toarray(), rotor.stiffness.toarray(), rtol=1e-15)
    np.testing.assert_allclose(model.mass.toarray(), rotor.mass.toarray(), rtol=1e-15)
    text = (export / "m.hb").read_text()
    (export / "m.hb").write_text(text[: text.rindex("\n", 0, -1) + 1])
    with pytest.raises(prs.PartFileError, match=r"its heading says .*: cut off"):
        prs.read_part("ansys", export / "k.hb", units="m-N-kg-s", **options)


@needs_data
@pytest.mark.parametrize(("first", "files"), [("K.mtx", {"M.mtx", "MAP.mtx"}), ("K.matrix", {"M.matrix", "K.mapping"})])
def test_the_recipes_of_the_guide(
    tmp_path: Path, rotor: LabelledMatrices, places: tuple[IntArray, FloatArray], first: str, files: set[str]
) -> None:
    """The files that the guide's commands leave, with the options it says."""
    lines = [line for line in PAGE.splitlines() if f"prs-model reduce {first} --reducer ansys" in line]
    options = dict(word.split("=") for word in lines[0].split() if word.startswith(("mass=", "map=", "coordinates=")))
    assert {options["mass"], options["map"]} == files
    for name, matrix in ((first, rotor.stiffness), (options["mass"], rotor.mass)):
        if first.endswith(".mtx"):
            (tmp_path / name).write_text(market(matrix.toarray()))
        else:
            hb_write(tmp_path / name, csc_array(tril(matrix)))
            (tmp_path / name).write_text((tmp_path / name).read_text().replace("RUA", "RSA"))
    rows = back(places[0]) if "*VEC,MAP,I,IMPORT,FULL,part.full,BACK" in PAGE else ""
    (tmp_path / options["map"]).write_text(rows if first.endswith(".mtx") else mapping(rotor.nodes, rotor.components))
    (tmp_path / options["coordinates"]).write_text(listing(*places))
    model = prs.read_part("ansys", tmp_path / first, units="m-N-kg-s", **options)
    np.testing.assert_allclose(model.stiffness.toarray(), rotor.stiffness.toarray(), rtol=1e-14)


@needs_data
def test_places_must_be_named() -> None:
    with pytest.raises(prs.PartFileError, match=r"does not say where its nodes are: name .*CDWRITE,DB,part,cdb"):
        prs.read_part("ansys", ROTOR, units="m-N-kg-s")


def without(word: str) -> Callable[[str], str]:
    return lambda text: "".join(line for line in text.splitlines(keepends=True) if not line.startswith(word))


@needs_data
@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("k.txt", lambda text: text[: len(text) // 2], "ends within its last line|cut off"),
        ("k.txt", lambda text: text.replace("general", "x").replace("symmetric", "general", 1), "one triangle only"),
        ("m.txt", lambda text: text.replace("345 345", "344 344", 1), "has 344 rows, expected 345|is 344x344|outside"),
        ("map.txt", lambda text: text.replace("\n31\n", f"\n{5000 * '3'}\n"), "expected a whole number"),
        ("map.txt", without("31"), "holds 114 numbers, its size line says"),
        ("map.txt", lambda text: text.replace("\n31\n", "\n0\n"), "it is the FORWARD vector"),
        ("map.txt", lambda text: text.replace("\n31\n", "\n17\n"), "names a node twice"),
        ("map.txt", lambda text: text.replace("\n31\n", "\n31131\n"), "have no coordinates in nodes.txt: 31131"),
        ("nodes.txt", without("31\t"), "have no coordinates in nodes.txt: 31"),
        ("nodes.txt", lambda text: text.replace("\n31\t", "\n31\tx", 1), "expected a number"),
        ("nodes.txt", lambda text: text.replace("\n31\t", "\n17\t", 1), "node 17 stands there twice"),
        ("nodes.txt", lambda text: "nothing\n", "has no nodes"),
    ],
)
def test_damaged_exports_are_refused(export: Path, name: str, change: Callable[[str], str], message: str) -> None:
    text = (export / name).read_text()
    assert change(text) != text
    (export / name).write_text(change(text))
    with pytest.raises(prs.PartFileError, match=message):
        prs.read_part("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS)


@needs_data
def test_the_unit_in_a_heading_counts(export: Path) -> None:
    with pytest.raises(prs.PartFileError, match=r"nodes\.txt: is in m, and 'units' says mm"):
        prs.read_part("ansys", export / "k.txt", units="mm-N-tonne-s", **OPTIONS)


@needs_data
def test_the_wrong_order_of_nodes_fails_the_gate(export: Path, places: tuple[IntArray, FloatArray]) -> None:
    swapped = places[0].copy()
    swapped[[3, 40]] = swapped[[40, 3]]
    (export / "map.txt").write_text(back(swapped))
    with pytest.raises(prs.PhysicsError, match="rigid motion costs energy"):
        prs.reduce("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS, interfaces=FOOT)


@needs_data
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: b"", "is empty"),
        (lambda data: data[:98304], "its header says 152664: cut off"),
        (lambda data: data[:24600] + bytes(byte ^ 0x55 for byte in data[24600:24640]) + data[24640:], "rigid motion"),
    ],
)
def test_damaged_full_files_are_refused(export: Path, change: Callable[[bytes], bytes], message: str) -> None:
    path = export / "bad.full"
    path.write_bytes(change(ROTOR.read_bytes()))
    with pytest.raises((prs.PartFileError, prs.PhysicsError), match=message):
        prs.reduce("ansys", path, units="m-N-kg-s", coordinates="nodes.txt", interfaces=FOOT)


ARCHIVE = """/COM,ANSYS RELEASE 20.1
NBLOCK,6,SOLID,        12,         3
(3i9,6e21.13e3)
        7        0        0 0.0000000000000E+000 1.0000000000000E+000
        8        0        0 2.0000000000000E+000 0.0000000000000E+000-3.0000000000000E+000
       12        0        0 0.0000000000000E+000 0.0000000000000E+000 0.0000000000000E+000 9.0000000000000E+001
N,R5.3,LOC,       -1,
CMBLOCK,BORE    ,NODE,       3  ! users node component
(8i10)
         7       -8        12
"""


def test_archives_give_places_axes_and_node_components(tmp_path: Path) -> None:
    path = tmp_path / "part.cdb"
    path.write_text(ARCHIVE)
    nodes = read_nodes(path)
    table = nodes.table
    assert table.labels.tolist() == [7, 8, 12]
    np.testing.assert_array_equal(table.coordinates, [[0.0, 1.0, 0.0], [2.0, 0.0, -3.0], [0.0, 0.0, 0.0]])
    assert table.frames is not None
    np.testing.assert_allclose(table.frames[2], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    np.testing.assert_array_equal(table.frames[:2], [np.eye(3)] * 2)
    assert nodes.components == {"BORE": (7, 8, 12)}
    assert nodes.length is None
    path.write_text(f"/UNITS,MPA\n{ARCHIVE}")
    mpa = read_nodes(path)
    assert mpa.length == "mm"
    mpa.check_units(Units.parse("mm-N-tonne-s"))
    with pytest.raises(prs.PartFileError, match=r"is in mm-N-tonne-s \(/UNITS\), and 'units' says mm-mN-kg-s"):
        mpa.check_units(Units.parse("mm-mN-kg-s"))
    path.write_text(ARCHIVE.replace("       -8 ", "-99999999"))
    with pytest.raises(prs.PartFileError, match=r"CMBLOCK BORE: '-99999999' ends no range"):
        read_nodes(path)
    path.write_text(ARCHIVE.replace("        12,         3", "        12,         4"))
    with pytest.raises(prs.PartFileError, match="holds 3 nodes and says 4"):
        read_nodes(path)
    path.write_text(ARCHIVE[: ARCHIVE.index("N,R5.3")])
    with pytest.raises(prs.PartFileError, match="has no end"):
        read_nodes(path)


def test_a_listing_of_nlist_has_pages_and_angles(tmp_path: Path) -> None:
    heading = " LIST ALL SELECTED NODES.   DSYS=      0\n\n   NODE        X       Y       Z      THXY   THYZ   THZX\n"
    path = tmp_path / "nlist.lis"
    path.write_text(
        f"{heading}      1  0.0  0.5  1.0   0.00  90.00   0.00\n\n{heading}      2 1.0 0.0 0.0 0.0 0.0 0.0\n"
    )
    table = read_nodes(path).table
    np.testing.assert_array_equal(table.coordinates, [[0.0, 0.5, 1.0], [1.0, 0.0, 0.0]])
    assert table.frames is not None
    path.write_text(path.read_text().replace("DSYS=      0", "DSYS=      1"))
    with pytest.raises(prs.PartFileError, match=r"line 1: is listed in coordinate system 1, .* after DSYS,0"):
        read_nodes(path)
    np.testing.assert_allclose(table.frames[0], [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-15)


@pytest.mark.parametrize("line", ["1, 2.0, 90.0, 0.5", "1,2.0,90.0,0.5", "1;2,0;90,0;0,5", "1; 2,0; 90,0; 0,5"])
def test_a_table_may_be_separated_by_commas_or_semicolons(tmp_path: Path, line: str) -> None:
    path = tmp_path / "nodes.csv"
    path.write_text(f"Node, X, Y, Z\n{line}\n")
    np.testing.assert_array_equal(read_nodes(path).table.coordinates, [[2.0, 90.0, 0.5]])


def test_a_table_of_workbench_writes_short_decimal_commas(tmp_path: Path) -> None:
    path = tmp_path / "nodes.txt"
    path.write_text("Knotennummer\tX-Position (m)\tY-Position (m)\tZ-Position (m)\t\r\n15\t-5,e-002\t0,15\t0,\t\r\n")
    table = read_nodes(path).table
    np.testing.assert_array_equal(table.coordinates, [[-0.05, 0.15, 0.0]])


def test_nodal_axes_turn_about_axes_already_turned() -> None:
    """x is turned towards y by THXY; THZX then turns z towards x about the y that has moved."""
    np.testing.assert_allclose(
        rotated_axes(np.array([90.0, 0.0, 90.0])), [[0, -1, 0], [0, 0, 1], [-1, 0, 0]], atol=1e-15
    )


@needs_data
def test_rotated_nodal_axes_are_turned_back(export: Path, rotor: LabelledMatrices) -> None:
    """One node's rows in axes turned by 30 degrees about z, and the node list says so: the same part."""
    turn = rotated_axes(np.array([30.0, 0.0, 0.0]))
    nodes = rotor.nodes[::3].tolist()
    at = 3 * nodes.index(50) + np.arange(3)
    to_body = np.eye(345)
    to_body[np.ix_(at, at)] = turn
    for name, matrix in (("k.txt", rotor.stiffness), ("m.txt", rotor.mass)):
        local = to_body.T @ matrix.toarray() @ to_body
        (export / name).write_text(market((local + local.T) / 2.0))
    table = (export / "nodes.txt").read_text().splitlines()
    angles = [f"{line.rstrip()}\t{30 if line.startswith('50' + chr(9)) else 0}\t0\t0" for line in table[1:]]
    (export / "nodes.txt").write_text("\n".join([table[0], *angles]) + "\n")
    model = prs.read_part("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS)
    np.testing.assert_allclose(model.stiffness.toarray(), rotor.stiffness.toarray(), atol=1e-6)
    assert prs.reduce("ansys", export / "k.txt", units="m-N-kg-s", **OPTIONS, interfaces=FOOT).check()


def test_a_clamped_beam_with_its_archive(caplog: pytest.LogCaptureFixture) -> None:
    """The example of ansys-mapdl-reader, 1 x 1 x 5, clamped at z = 0. Frequencies: README of pymapdl-reader."""
    options = {"units": "m-N-kg-s", "coordinates": str(EXAMPLES / "HexBeam.cdb")}
    model = prs.read_part("ansys", CLAMPED, **options)
    assert not caplog.records
    assert model.size == 900  # 321 nodes less 21 that are held
    np.testing.assert_allclose(model.frequencies(4), [1283.200, 1283.200, 5781.975, 6919.399], atol=6e-4)
    np.testing.assert_allclose(model.mass_properties().centre[:2], [0.5, 0.5], rtol=1e-9)
    tip = {"tip": {"plane": {"point": [0.0, 0.0, 5.0], "normal": [0.0, 0.0, 1.0], "tolerance": 1e-6}}}
    element = prs.reduce("ansys", CLAMPED, **options, interfaces=tip, grounded=True, modes=6)
    lowest = summarize(element).free[0]
    assert 1283.2 <= lowest < 1.01 * 1283.2  # from above: the tip is rigid, the modes are few


def test_rows_in_another_order_show_against_the_elements_of_an_archive(tmp_path: Path) -> None:
    """Of a part that is held to the ground the physics gate cannot see it."""
    part = load_full(CLAMPED)
    options = {"mass": "M.matrix", "map": "K.mapping", "coordinates": str(EXAMPLES / "HexBeam.cdb")}
    for name, matrix in (("K.matrix", part.stiffness), ("M.matrix", part.mass)):
        hb_write(tmp_path / name, csc_array(tril(matrix)))
        (tmp_path / name).write_text((tmp_path / name).read_text().replace("RUA", "RSA"))
    (tmp_path / "K.mapping").write_text(mapping(part.nodes, part.components))
    assert prs.read_part("ansys", tmp_path / "K.matrix", units="m-N-kg-s", **options).size == 900
    swapped = part.nodes.copy()
    swapped[[0, 1, 2, 300, 301, 302]] = swapped[[300, 301, 302, 0, 1, 2]]
    (tmp_path / "K.mapping").write_text(mapping(swapped, part.components))
    with pytest.raises(prs.PartFileError, match=r"act on each other, but share no element of HexBeam\.cdb"):
        prs.read_part("ansys", tmp_path / "K.matrix", units="m-N-kg-s", **options)


def test_the_archive_of_another_part_is_refused() -> None:
    with pytest.raises(prs.PartFileError, match=r"share no element of TetBeam\.cdb"):
        prs.read_part("ansys", CLAMPED, units="m-N-kg-s", coordinates=str(EXAMPLES / "TetBeam.cdb"))


@needs_data
def test_the_list_of_another_part_is_noticed(export: Path, caplog: pytest.LogCaptureFixture) -> None:
    with (export / "nodes.txt").open("a") as file:
        file.write("9001\t0\t0\t0\n")
    prs.read_part("ansys", ROTOR, units="m-N-kg-s", coordinates=str(export / "nodes.txt"))
    assert "have no rows in sparse.full: constrained, or is it the list of another part?" in caplog.text
