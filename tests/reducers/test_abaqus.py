"""The abaqus reducer: stored exports, and files written here as Abaqus lays them down, against their model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation

import prs_model as prs
from prs_model.description.units import Units
from prs_model.finite_elements import FiniteElementModel
from tests.meshes import box, steel
from tests.reducers.decks import BAR_MASS, changed, write_bar, write_deck, write_labelled
from tests.superelements import DATA, needs_data, reference

UNITS = "mm-N-tonne-s"
MESH = box((0.4, 0.1, 0.06), (4, 1, 1))
MODEL = steel(MESH)
LABELS = 7 + 3 * np.random.default_rng(1).permutation(len(MESH.points))
ENDS = {"root": {"set": "Nx0"}, "tip": {"set": "Nx1"}}
# N/mm and t from N/m and kg
STIFFNESS, MASS = MODEL.stiffness.toarray() / 1e3, MODEL.mass.toarray() / 1e3


def read(source: Path, units: str = UNITS, **options: object) -> FiniteElementModel:
    model = prs.read_part("abaqus", source, units=units, **options)
    assert isinstance(model, FiniteElementModel)
    return model


@needs_data
@pytest.mark.parametrize(("record", "file"), [("blockC3D10", "blockC3D10_STIF1"), ("rotorDisc", "rotorDiscTestSTIF1")])
def test_stored_exports_are_as_recorded(record, file):
    expected = reference(f"abaqus/{record}")
    model = read(DATA / "abaqus" / f"{file}.mtx", "m-N-kg-s")
    assert model.size == expected["size"][0]
    phi = model.rigid_body_modes()
    np.testing.assert_allclose(np.diag(phi.T @ (model.mass @ phi))[:3], expected["mass_xyz"], rtol=1e-13)
    np.testing.assert_allclose(model.mass_properties().centre, expected["cg"], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(model.frequencies(14)[6:], expected["freq_hz_first"][6:], rtol=1e-9)
    assert np.linalg.norm(model.stiffness @ phi) < 1e-12 * np.linalg.norm(model.stiffness.data) * np.linalg.norm(phi)


@needs_data
def test_a_surface_of_the_deck_is_an_interface_with_its_areas():
    """The rotor's named surface is all of its skin, so its areas are those of the outer surface."""
    model = read(DATA / "abaqus" / "rotorDiscTestSTIF1.mtx", "m-N-kg-s")
    assert model.areas is not None
    np.testing.assert_allclose(model.set_weights["Surface"], model.areas[model.node_sets["Surface"]], rtol=1e-12)
    assert model.set_weights["Surface"].sum() == pytest.approx(model.areas.sum(), rel=1e-12)


def exported(folder: Path, stiffness: np.ndarray = STIFFNESS, mass: np.ndarray = MASS, more: str = "") -> Path:
    """The box as FORMAT=MATRIX INPUT, in mm, its labels in no order."""
    write_deck(folder / "job.inp", MESH, LABELS, scale=1e3, more=more)
    write_labelled(folder / "job_MASS2.mtx", mass, MODEL, LABELS)
    return write_labelled(folder / "job_STIF2.mtx", stiffness, MODEL, LABELS)


def of_box(found: FiniteElementModel) -> np.ndarray:
    """(n,) the row of the box's own model for each row found."""
    assert found.node_ids is not None
    at = {label: index for index, label in enumerate(LABELS.tolist())}
    return np.array([MODEL.rows[at[found.node_ids[node]], component] for node, component in found.dofs])


def test_labelled_rows_are_the_model_they_are_of(tmp_path):
    found = read(exported(tmp_path))
    rows = of_box(found)
    for ours, own in ((found.stiffness, MODEL.stiffness), (found.mass, MODEL.mass)):
        expected = own.toarray()[np.ix_(rows, rows)]
        np.testing.assert_allclose(ours.toarray(), expected, atol=1e-14 * expected.max())
    assert found.areas is not None
    assert found.areas.sum() == pytest.approx(2 * (0.4 * 0.1 + 0.1 * 0.06 + 0.4 * 0.06), rel=1e-12)
    for name, other in (("Nx0", "x0"), ("Nz1", "z1")):
        np.testing.assert_array_equal(found.node_sets[name], np.unique(MESH.groups[other]))


def test_node_labels_name_an_interface(tmp_path):
    corners = np.flatnonzero(MESH.points[:, 0] == 0.0)
    source = exported(tmp_path)
    options = {"units": UNITS, "modes": 3}
    by_label = prs.reduce("abaqus", source, nodes={"root": [int(label) for label in LABELS[corners]]}, **options)
    by_set = prs.reduce("abaqus", source, interfaces={"root": {"set": "Nx0"}}, **options)
    same = {"mass": by_label.mass_properties().mass, "nodes": by_label.nodes}
    assert same == {"mass": pytest.approx(by_set.mass_properties().mass, rel=1e-12), "nodes": by_set.nodes}


def test_motions_held_by_a_penalty_are_held(tmp_path):
    """Abaqus writes 1e36 on the diagonal where *BOUNDARY holds a motion."""
    held = MODEL.rows_of(np.unique(MESH.groups["x0"]))
    stiffness = STIFFNESS.copy()
    stiffness[held, held] = 1e36
    source = exported(tmp_path, stiffness, more="*BOUNDARY\nNx0, ENCASTRE\n")
    element = prs.reduce("abaqus", source, interfaces={"tip": ENDS["tip"]}, units=UNITS, grounded=True, modes=4)
    free = exported(tmp_path)
    clamped = prs.reduce(
        "abaqus", free, interfaces={"tip": ENDS["tip"]}, units=UNITS, clamped=["Nx0"], grounded=True, modes=4
    )
    np.testing.assert_allclose(element.stiffness, clamped.stiffness, atol=1e-9 * np.abs(clamped.stiffness).max())
    np.testing.assert_allclose(element.mass, clamped.mass, atol=1e-9 * np.abs(clamped.mass).max())


def cylindrical(point: np.ndarray) -> np.ndarray:
    """Radial, tangential, axial about the z axis through (-1, 0)."""
    radial = np.array([point[0] + 1.0, point[1], 0.0]) / np.hypot(point[0] + 1.0, point[1])
    return np.column_stack([radial, [-radial[1], radial[0], 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("kind", ["R", "C"])
def test_local_axes_are_turned_back(tmp_path, kind):
    """*TRANSFORM: motions of the turned nodes are written along axes of their own."""
    nodes = np.unique(MESH.groups["x1"])
    rectangular = Rotation.from_euler("z", 30, degrees=True).as_matrix()
    frames = np.tile(np.eye(3), (len(MESH.points), 1, 1))
    for node in nodes:
        frames[node] = rectangular if kind == "R" else cylindrical(MESH.points[node])
    turn = block_diag(*frames)
    x, y = rectangular[:, 0], rectangular[:, 1]
    data = [*x, *(y + 0.5 * x)] if kind == "R" else [-1e3, 0, 0, -1e3, 0, 50]
    more = f"*TRANSFORM, NSET=Nx1, TYPE={kind}\n" + ", ".join(f"{value:.16g}" for value in data) + "\n"
    found = read(exported(tmp_path, turn.T @ STIFFNESS @ turn, turn.T @ MASS @ turn, more))
    rows = of_box(found)
    expected = MODEL.stiffness.toarray()[np.ix_(rows, rows)]
    np.testing.assert_allclose(found.stiffness.toarray(), expected, atol=1e-12 * np.abs(expected).max())


def test_a_mass_file_cut_short_is_seen_in_a_frame_of_beams_too(tmp_path):
    """Nodes without rows in the mass file could be massless; those of beams are not."""
    source = write_bar(tmp_path)
    assert read(source, "m-N-kg-s").mass_properties().mass == pytest.approx(BAR_MASS, rel=1e-12)
    mass = tmp_path / "job_MASS1.mtx"
    lines = mass.read_text().splitlines(keepends=True)
    for kept, message in (
        (len(lines) // 2, "rows of elements with mass have none, the first at node"),
        (-1, "the mass between 2 uy and 7 rz is more than their own allow"),
    ):
        mass.write_text("".join(lines[:kept]))
        with pytest.raises(prs.PartFileError, match=message):
            read(source, "m-N-kg-s")


def test_constraints_may_move_mass_along_one_axis(tmp_path):
    """*EQUATION ties ux of two nodes: the mass of the one that follows then is part of the other's, along x."""
    kept, gone = (int(MODEL.rows[node, 0]) for node in (0, 8))
    follow = np.eye(MODEL.size)
    follow[gone, gone], follow[gone, kept] = 0.0, 1.0
    free = np.delete(np.arange(MODEL.size), gone)
    stiffness, mass = ((follow.T @ matrix @ follow)[np.ix_(free, free)] for matrix in (STIFFNESS, MASS))
    model = replace(MODEL, stiffness=csr_array(stiffness), mass=csr_array(mass), dofs=MODEL.dofs[free])
    equation = f"*EQUATION\n2\n{LABELS[8]}, 1, 1., {LABELS[0]}, 1, -1.\n"
    write_deck(tmp_path / "job.inp", MESH, LABELS, scale=1e3, more=equation)
    write_labelled(tmp_path / MASS2, mass, model, LABELS)
    source = write_labelled(tmp_path / STIF, stiffness, model, LABELS)
    found = read(source)
    along_x = found.dofs[:, 1] == 0
    assert found.mass[along_x][:, along_x].sum() == pytest.approx(MODEL.mass_properties().mass, rel=1e-12)


def line(path: Path, number: int, text: str) -> None:
    lines = path.read_text().splitlines(keepends=True)
    lines[number - 1] = text + "\n"
    path.write_text("".join(lines))


STIF, MASS2 = "job_STIF2.mtx", "job_MASS2.mtx"


def entry(path: Path, value: str) -> None:
    """The first number of the diagonal, in place of its own."""
    lines = path.read_text().splitlines()
    at = next(i for i, text in enumerate(lines) if text.split(", ")[0] == text.split(", ")[1])
    line(path, at + 1, f"{lines[at].rpartition(' ')[0]} {value}")


def held_alone(folder: Path) -> None:
    """A motion far from those that the deck holds."""
    entry(folder / STIF, "1.e36")
    with (folder / "job.inp").open("a") as deck:
        deck.write("*BOUNDARY\n" + "".join(f"{label}, 4, 6\n" for label in LABELS[:3]))


BAD = {
    "mass absent": (lambda at: (at / MASS2).unlink(), f"{MASS2}: there is no such file"),
    "no number": (lambda at: line(at / STIF, 5, "7,1, 7,1, x"), f"{STIF}: line 5: found 'x', expected a number"),
    "numbers missing": (lambda at: line(at / STIF, 5, "7,1, 7,1"), f"{STIF}: line 5: found 4 numbers, expected 5"),
    "an internal node": (lambda at: line(at / STIF, 5, "-1,1, 7,1, 1."), "1 entries belong to nodes that Abaqus makes"),
    "a dof of heat": (lambda at: line(at / STIF, 5, "7,11, 7,1, 1."), "node 7 has dof 11, expected displacements"),
    "half a node": (
        lambda at: line(at / STIF, 5, "7.5,1, 7,1, 1."),
        "row and column: found 7.5, expected whole numbers",
    ),
    "a row twice": (lambda at: line(at / STIF, 5, (at / STIF).read_text().splitlines()[5]), "two values for one row"),
    "loads": (lambda at: line(at / STIF, 1, "*CLOAD, REAL"), r"found '\*CLOAD, REAL', expected a stiffness or mass"),
    "other formats": (lambda at: (at / MASS2).write_text("1 1 1.0\n"), "another FORMAT than job_STIF2.mtx"),
    "another part": (
        lambda at: line(at / MASS2, 5, "99999,1, 99999,1, 1."),
        "node 99999, dof 1, which the stiffness has",
    ),
    "truncated": (lambda at: (at / MASS2).write_text((at / MASS2).read_text()[:9000]), "have no mass|expected 5|share"),
    "a lost element": (lambda at: changed(at / "job.inp", "\n5, ", "\n** "), "act on each other, but share no element"),
    "no deck": (lambda at: (at / "job.inp").unlink(), "job.inp: there is no such file: 'mesh' is looked for beside"),
    "not finite": (lambda at: entry(at / STIF, "inf"), r"STIF2.mtx: found inf in the entry \d+, \d, \d+, \d, expected"),
    "no number at all": (lambda at: entry(at / MASS2, "nan"), r"MASS2.mtx: found nan in the entry"),
    "nearly held": (lambda at: entry(at / STIF, "1.e35"), r"found 1e\+35 on the diagonal for node .*writes 1e\+36"),
    "held by chance": (
        lambda at: held_alone(at),
        r"1 motions are held here or by \*BOUNDARY of job.inp, but not by both",
    ),
    "a table": (lambda at: (at / STIF).write_text("1, 2\n"), "its lines hold 2 numbers, expected 3 .* or 5"),
}


@pytest.mark.parametrize("what", BAD)
def test_damaged_matrices_are_refused(tmp_path, what):
    damage, message = BAD[what]
    source = exported(tmp_path)
    damage(tmp_path)
    with pytest.raises(prs.PartFileError, match=message):
        read(source)


def test_unlabelled_rows_must_fit_the_deck(tmp_path):
    """In coordinate form rows follow the deck's nodes: neither another order of them nor another number passes."""
    for name, matrix in ((STIF, STIFFNESS), (MASS2, MASS)):
        rows, columns = np.nonzero(matrix)
        entries = zip(rows + 1, columns + 1, matrix[rows, columns], strict=True)
        (tmp_path / name).write_text("".join(f"{i} {j} {value:.15e}\n" for i, j, value in entries))
    write_deck(tmp_path / "job.inp", MESH, LABELS, scale=1e3)
    np.testing.assert_allclose(read(tmp_path / STIF).frequencies(10)[6:], MODEL.frequencies(10)[6:], rtol=1e-9)
    np.testing.assert_allclose(read(tmp_path / MASS2).frequencies(10)[6:], MODEL.frequencies(10)[6:], rtol=1e-9)
    text = (tmp_path / "job.inp").read_text().splitlines()
    text[2], text[40] = text[40], text[2]
    (tmp_path / "job.inp").write_text("\n".join(text))
    with pytest.raises(prs.PartFileError, match="act on each other, but share no element"):
        read(tmp_path / STIF)
    (tmp_path / "job.inp").write_text("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n")
    with pytest.raises(prs.PartFileError, match=f"has {MODEL.size} rows, but job.inp has 2 nodes"):
        read(tmp_path / STIF)


def test_companions_are_named_by_options_too(tmp_path):
    source = exported(tmp_path)
    renamed = {name: (tmp_path / name).rename(tmp_path / other) for name, other in (
        (STIF, "k.mtx"), (MASS2, "m.txt"), ("job.inp", "mesh.dat"))}  # fmt: skip
    found = read(renamed[STIF], mass="m.txt", mesh="mesh.dat")
    assert found.size == MODEL.size
    with pytest.raises(prs.PartFileError, match=r"say 'options: \{mass: <file>\}'"):
        read(renamed[STIF], mesh="mesh.dat")
    assert not source.exists()


def test_a_name_may_have_dots(tmp_path):
    exported(tmp_path)
    for name in (STIF, MASS2, "job.inp"):
        (tmp_path / name).rename(tmp_path / name.replace("job", "rod.v2"))
    assert read(tmp_path / "rod.v2_STIF2.mtx").size == MODEL.size


def test_the_deck_is_not_the_source(tmp_path):
    exported(tmp_path)
    with pytest.raises(
        prs.PartFileError, match=r".inp is not read, expected the stiffness .*beside it are job_MASS2.mtx"
    ):
        read(tmp_path / "job.inp")


def test_units_of_the_file_are_asked_for(tmp_path):
    source = exported(tmp_path)
    with pytest.raises(prs.PartFileError, match="units"):
        prs.read_part("abaqus", source)
    assert read(source).mass_properties().mass == pytest.approx(7850.0 * 0.4 * 0.1 * 0.06, rel=1e-12)
    assert Units.parse(UNITS).length == "mm"
