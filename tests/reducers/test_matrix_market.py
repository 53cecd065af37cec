"""Matrix Market files with a table of rows: read strictly, written, read back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.units import Units
from prs_model.finite_elements.rigid_motion import transfer
from prs_model.plugins import reducer
from prs_model.testing.element import plain_element

LENGTH, AREA, E, DENSITY = 0.4, 1e-3, 2.1e11, 7850.0


def springs_and_mode(modes: bool = True) -> prs.SuperElement:
    """Two nodes with six motions each, one mode; free, and with the mass of a body."""
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.1, 0.0]])
    rigid = transfer(points).reshape(12, 6)
    inner = np.linalg.svd(rigid)[0][:, 6:]
    scale = np.diag([1.0] * 3 + [0.1] * 3)
    weight = np.kron(np.eye(2), scale)
    stiffness = np.zeros((13, 13))
    stiffness[:12, :12] = inner @ np.diag(np.linspace(1e6, 2e6, 6)) @ inner.T
    stiffness[12, 12] = (2.0 * np.pi * 300.0) ** 2
    mass = np.eye(13)
    mass[:12, :12] = weight @ np.diag([2.0, 2.0, 2.0, 3.0, 3.0, 3.0] * 2) @ weight
    selectors = np.eye(13)[:12].reshape(2, 6, 13)
    n = 13 if modes else 12
    return prs.SuperElement(
        stiffness=stiffness[:n, :n],
        mass=mass[:n, :n],
        nodes=("big end", "tip"),
        positions=points,
        motions=selectors[:, :, :n],
        n_modes=int(modes),
        node_sets={"ends": ("big end", "tip")},
        provenance={"modes": "fixed-interface"} if modes else {},
    )


def written(folder: Path, units: str = "m-N-kg-s", modes: bool = True) -> Path:
    path = folder / "part.mtx"
    reducer("matrix_market").write(springs_and_mode(modes), path, Units.parse(units))
    return path


@pytest.mark.parametrize("modes", [True, False])
def test_what_is_written_comes_back_as_it_was(tmp_path: Path, modes: bool) -> None:
    element = springs_and_mode(modes)
    back = prs.reduce("matrix_market", written(tmp_path, modes=modes), units="m-N-kg-s")
    for name in ("stiffness", "mass", "positions", "motions"):
        np.testing.assert_array_equal(getattr(back, name), getattr(element, name))
    assert (back.nodes, back.n_modes, back.node_sets) == (element.nodes, element.n_modes, element.node_sets)
    assert back.provenance.get("modes") == element.provenance.get("modes")


def test_millimetres_and_tonnes_are_the_same_part(tmp_path: Path) -> None:
    back = prs.reduce("matrix_market", written(tmp_path, "mm-N-tonne-s"), units="mm-N-tonne-s")
    np.testing.assert_allclose(back.stiffness, springs_and_mode().stiffness, rtol=1e-14, atol=1e-8)
    np.testing.assert_allclose(back.mass, springs_and_mode().mass, rtol=1e-14, atol=1e-15)


def test_units_that_contradict_the_table_are_refused(tmp_path: Path) -> None:
    with pytest.raises(prs.PartFileError, match="is in m-N-kg-s, and 'units' says mm-N-tonne-s"):
        prs.reduce("matrix_market", written(tmp_path), units="mm-N-tonne-s")


def test_units_are_those_of_the_table_where_nobody_says_them(tmp_path: Path) -> None:
    back = prs.reduce("matrix_market", written(tmp_path, "mm-N-tonne-s"))
    np.testing.assert_allclose(back.positions, springs_and_mode().positions, rtol=1e-15)
    with pytest.raises(prs.PartFileError, match=r"rod\.mtx: the file does not say its units"):
        prs.read_part("matrix_market", rod(tmp_path))


@pytest.mark.parametrize("comment", ["unit: mm-N-tonne-s", "mode: fixed-interface", "sets bore: 10 20"])
def test_a_mistyped_fact_is_noticed(tmp_path: Path, caplog: pytest.LogCaptureFixture, comment: str) -> None:
    source = rod(tmp_path)
    table = tmp_path / "rod_dofs.txt"
    table.write_text(f"# {comment}\n# written on: Monday\n{table.read_text()}")
    prs.read_part("matrix_market", source, units="m-N-kg-s")
    (record,) = caplog.records
    assert f"rod_dofs.txt: the comment '# {comment}' says nothing here; did you mean" in record.getMessage()


def test_an_averaged_node_cannot_be_written(tmp_path: Path) -> None:
    plain = springs_and_mode(True)
    element = replace(
        plain,
        nodes=("middle", *plain.nodes),
        positions=np.vstack([plain.positions.mean(axis=0), plain.positions]),
        motions=np.concatenate([plain.motions.mean(axis=0)[None], plain.motions]),
    )
    with pytest.raises(prs.PartFileError, match=r"cannot hold .* store it as \.npz"):
        reducer("matrix_market").write(element, tmp_path / "other.mtx", Units())
    assert not (tmp_path / "other.mtx").exists()


@pytest.mark.parametrize("name", ["part.mtx", "part_mass.mtx"])
def test_another_digit_is_noticed_in_what_we_wrote(tmp_path: Path, name: str) -> None:
    """A plausible part, but not the one that was written."""
    source = written(tmp_path)
    text = (tmp_path / name).read_text()
    digit = len(text) - 8
    (tmp_path / name).write_text(text[:digit] + str(9 - int(text[digit])) + text[digit + 1 :])
    with pytest.raises(prs.PartFileError, match=r"part_dofs\.txt was written with"):
        prs.reduce("matrix_market", source, units="m-N-kg-s")
    (tmp_path / name).write_text(text.replace("\n", "\r\n"))
    assert prs.reduce("matrix_market", source, units="m-N-kg-s").size == 13


def rod(folder: Path) -> Path:
    """Four bars in a row along x, only ux: its lowest modes are known, 1-d matrices by hand."""
    k, m = E * AREA / (LENGTH / 4), DENSITY * AREA * LENGTH / 4 / 6
    lines = {"rod": [], "rod_mass": []}
    for i in range(1, 6):
        ends = 1 if i in (1, 5) else 2
        lines["rod"] += [f"{i} {i} {ends * k}"] + ([f"{i + 1} {i} {-k}"] if i < 5 else [])
        lines["rod_mass"] += [f"{i} {i} {ends * 2 * m}"] + ([f"{i + 1} {i} {m}"] if i < 5 else [])
    for name, entries in lines.items():
        head = f"%%MatrixMarket matrix coordinate real symmetric\n% four bars\n5 5 {len(entries)}\n"
        (folder / f"{name}.mtx").write_text(head + "\n".join(entries) + "\n")
    rows = [f"{i}, {10 * i}, 1, {LENGTH / 4 * (i - 1)}, 0.0, 0.0" for i in range(1, 6)]
    (folder / "rod_dofs.txt").write_text("row, node, component, x, y, z\n" + "\n".join(rows) + "\n")
    return folder / "rod.mtx"


def test_full_matrices_are_a_finite_element_model(tmp_path: Path) -> None:
    """Longitudinal waves of a free rod of n linear elements: w^2 = 6 E/(rho h^2) (1-cos)/(2+cos)."""
    model = prs.read_part("matrix_market", rod(tmp_path), units="m-N-kg-s")
    assert isinstance(model, prs.FiniteElementModel)
    angle = np.pi * np.arange(5) / 4
    expected = np.sqrt(6.0 * E / DENSITY / 0.1**2 * (1 - np.cos(angle)) / (2 + np.cos(angle))) / (2.0 * np.pi)
    np.testing.assert_allclose(model.frequencies(5), expected, atol=0.1, rtol=1e-9)


DAMAGE = {
    "empty": ("rod.mtx", lambda text: "", "is empty"),
    "cut between lines": ("rod.mtx", lambda text: text[: text.rindex("\n", 0, -1) + 1], "cut off"),
    "cut in a number": ("rod.mtx", lambda text: text[:-3], "ends within its last line"),
    "mass cut": ("rod_mass.mtx", lambda text: text[: len(text) // 2], "ends within|cut off"),
    "entry twice": ("rod.mtx", lambda text: text.replace("5 4 ", "4 3 "), "an entry twice"),
    "outside": ("rod.mtx", lambda text: text.replace("5 4 ", "9 4 "), "outside of the 5 rows"),
    "one triangle said to be both": ("rod.mtx", lambda text: text.replace("symmetric", "general"), "one triangle only"),
    "complex": ("rod.mtx", lambda text: text.replace("real", "complex"), "expected a matrix, coordinate or array"),
    "another size": ("rod_mass.mtx", lambda text: text.replace("5 5 9", "6 6 9"), "has 6 rows, expected 5"),
    "something behind a number": ("rod.mtx", lambda text: text.replace("5 4 ", "5 4 1 "), "found 4 numbers"),
    "a size of many digits": ("rod.mtx", lambda text: text.replace("5 5 9", "5 5 " + 5000 * "9"), "line 3, the sizes"),
    "of Abaqus": ("rod.mtx", lambda text: "1,1, 1,1, 2.0\n2,1, 2,1, 3.0\n", "is read by the reducer 'abaqus'"),
    "letters": ("rod.mtx", lambda text: text.replace("5 4 ", "5 4 x"), "line 11: found .*, expected a number"),
    "not a number": ("rod.mtx", lambda text: text.replace("5 4 -", "5 4 nan\n%"), "cut off|expected|finite"),
    "other kind": ("rod.mtx", lambda text: "PK\3\4\0" + text, "binary"),
    "table: row twice": ("rod_dofs.txt", lambda text: text.replace("5, 50", "4, 50"), "row 4 stands there twice"),
    "table: row missing": (
        "rod_dofs.txt",
        lambda text: text.replace("2, 20, 1, 0.1, 0.0, 0.0\n", ""),
        "row 2 is missing",
    ),
    "table: same node": ("rod_dofs.txt", lambda text: text.replace("5, 50", "5, 40"), "node 40 was at 0.3 0 0 before"),
    "table: component 0": ("rod_dofs.txt", lambda text: text.replace("50, 1", "50, 0"), "found component '0'"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_files_are_refused(tmp_path: Path, damage: str) -> None:
    name, change, message = DAMAGE[damage]
    source = rod(tmp_path)
    text = (tmp_path / name).read_text()
    assert change(text) != text
    (tmp_path / name).write_text(change(text))
    with pytest.raises(prs.PartFileError, match=message):
        prs.read_part("matrix_market", source, units="m-N-kg-s")


def test_a_missing_companion_is_named(tmp_path: Path) -> None:
    source = rod(tmp_path)
    (tmp_path / "rod_mass.mtx").unlink()
    with pytest.raises(prs.PartFileError, match=r"rod_mass\.mtx: there is no such file"):
        prs.read_part("matrix_market", source, units="m-N-kg-s")


def test_fortran_exponents_and_gzip(tmp_path: Path) -> None:
    import gzip

    source = rod(tmp_path)
    plain = prs.read_part("matrix_market", source, units="m-N-kg-s")
    lines = source.read_text().splitlines()
    fortran = [f"{a} {b} {float(c):.15e}".replace("e", "D") for a, b, c in map(str.split, lines[3:])]
    packed = tmp_path / "rod.mtx.gz"
    packed.write_bytes(gzip.compress(("\n".join(lines[:3] + fortran) + "\n").encode()))
    same = prs.read_part("matrix_market", packed, units="m-N-kg-s")
    np.testing.assert_allclose(same.stiffness.toarray(), plain.stiffness.toarray(), rtol=1e-15)


def test_swapped_rows_fail_the_gate(tmp_path: Path) -> None:
    source = written(tmp_path)
    table = tmp_path / "part_dofs.txt"
    text = table.read_text()
    table.write_text(text.replace('2 "big end" uy', '2 "big end" rz').replace('6 "big end" rz', '6 "big end" uy'))
    with pytest.raises(prs.PhysicsError):
        prs.reduce("matrix_market", source, units="m-N-kg-s")


def test_what_others_wrote_is_not_replaced(tmp_path):
    for _ in range(2):
        prs.export(plain_element(), tmp_path / "ours.mtx")
    (tmp_path / "theirs.mtx").write_text("%%MatrixMarket matrix array real general\n1 1\n1.0\n")
    with pytest.raises(prs.PartFileError, match=r"theirs\.mtx: is there already, and was not written by this program"):
        prs.export(plain_element(), tmp_path / "theirs.mtx")
