"""Super-elements written for Nastran and read back: OP4 to the bit, punches to the digits of their fields."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import prs_model as prs
from prs_model.description.units import Units
from prs_model.reduction import SuperElement
from prs_model.testing.element import plain_element
from prs_reducers import nastran
from tests.superelements import DATA, needs_data

pytest.importorskip("pyyeti")

SI, MM = "m-N-kg-s", "mm-N-tonne-s"


def turned(element: SuperElement) -> SuperElement:
    """The same part; its second node's coordinates are along axes of its own."""
    R = Rotation.from_rotvec([0.3, -0.5, 0.7]).as_matrix()
    T = np.eye(element.size)
    T[6:9, 6:9] = T[9:12, 9:12] = R
    motions = element.motions @ T
    motions[np.abs(motions) < 1e-15] = 0.0
    return replace(element, stiffness=T.T @ element.stiffness @ T, mass=T.T @ element.mass @ T, motions=motions)


def write(element: SuperElement, path: Path, units: str = SI) -> None:
    nastran.NastranReducer().write(element, path, Units.parse(units))


def sent(element: SuperElement, path: Path, units: str = SI) -> SuperElement:
    write(element, path, units)
    found = prs.read_part("nastran", path, units=units)
    assert isinstance(found, SuperElement)
    return found


def close(one: SuperElement, other: SuperElement, accuracy: float) -> None:
    assert (one.nodes, one.labels, one.n_modes) == (other.nodes, other.labels, other.n_modes)
    for name in ("stiffness", "mass", "positions", "motions"):
        a, b = getattr(one, name), getattr(other, name)
        assert np.allclose(a, b, rtol=accuracy, atol=accuracy * np.abs(b).max())


@needs_data
def test_an_export_written_again_is_the_same_to_the_bit(tmp_path: Path) -> None:
    """With the turned output frame of grid 11, and its scalar points' numbers."""
    element = prs.read_part("nastran", DATA / "nastran_extseout" / "inboard.op4", units=SI)
    assert isinstance(element, SuperElement)
    found = sent(element, tmp_path / "part.op4")
    close(found, element, 0.0)
    found.check()


@pytest.mark.parametrize(("suffix", "accuracy"), [(".op4", 1e-14), (".pch", 2e-10)])
def test_turned_frames_names_and_units(tmp_path: Path, suffix: str, accuracy: float) -> None:
    element = turned(plain_element())
    labels = [label.replace("11.", "hinge.").replace("23.", 'Ø "b" $.') for label in element.labels]
    element = replace(element, nodes=("hinge", 'Ø "b" $'), labels=tuple(labels))
    found = sent(element, tmp_path / f"part{suffix}", MM)
    close(replace(found, motions=element.motions), element, accuracy)
    assert np.allclose(found.motions, element.motions, atol=1e-10)  # axes in fields of 16 characters
    found.check()


def test_a_node_of_few_components(tmp_path: Path) -> None:
    whole = plain_element()
    kept = [*range(6), 7, 10, *range(12, whole.size)]
    element = replace(
        whole,
        stiffness=whole.stiffness[np.ix_(kept, kept)],
        mass=whole.mass[np.ix_(kept, kept)],
        motions=whole.motions[:, :, kept],
        labels=tuple(whole.labels[row] for row in kept),
    )
    for suffix, accuracy in ((".op4", 0.0), (".pch", 1e-10)):
        close(sent(element, tmp_path / f"part{suffix[1:]}{suffix}"), element, accuracy)


def test_pyyeti_takes_the_files_too(tmp_path: Path) -> None:
    from pyyeti.nastran import asm2uset, op4, rddmig

    element = turned(plain_element())
    write(element, tmp_path / "part.op4")
    write(element, tmp_path / "punch.pch")
    with (tmp_path / "part.asm").open() as file:
        uset = asm2uset(file)[0]
    assert [str(point) for point in uset.index.get_level_values("id")[:12:6]] == list(element.nodes)
    matrices = op4.read(str(tmp_path / "part.op4"))
    assert np.array_equal(matrices["kxx"], element.stiffness)
    punched = rddmig(str(tmp_path / "punch.pch"), square=True)
    assert sorted(np.linalg.eigvalsh(punched["kaax"].to_numpy())) == pytest.approx(
        np.linalg.eigvalsh(element.stiffness), abs=1e-9 * np.abs(element.stiffness).max()
    )


def test_what_has_no_rows_in_nastran(tmp_path: Path) -> None:
    """A rigid body's six coordinates move both of its nodes."""
    element = plain_element()
    phi = element.rigid_body_modes()
    body = SuperElement(
        stiffness=np.zeros((6, 6)),
        mass=phi.T @ element.mass @ phi,
        nodes=element.nodes,
        positions=element.positions,
        motions=element.motions @ phi,
    )
    with pytest.raises(prs.PartFileError, match="coordinate 1 moves 11, 23, expected one node"):
        write(body, tmp_path / "body.op4")
    assert not list(tmp_path.iterdir())


def test_damage_that_no_format_shows(tmp_path: Path) -> None:
    """One entry less in a symmetric mass matrix is as good a matrix; the sum at the end of what we write tells."""
    path = tmp_path / "part.pch"
    sent(plain_element(), path)
    lines = path.read_text().splitlines(keepends=True)
    for damaged in (lines[:-2] + lines[-1:], lines[:-2]):
        path.write_text("".join(damaged))
        with pytest.raises(prs.PartFileError, match=r"not as it was written: it is damaged, or was edited"):
            prs.read_part("nastran", path, units=SI)
    path.write_text("".join(lines).replace("\n", "\r\n"))
    prs.read_part("nastran", path, units=SI)


@pytest.mark.parametrize("suffix", [".op4", ".pch"])
def test_files_say_their_units_and_that_the_part_is_held(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"part{suffix}"
    element = replace(plain_element(), grounded=True)
    write(element, path, MM)
    assert "$ held to the ground: say 'grounded: true'" in path.with_suffix(".pch").read_text()
    found = prs.read_part("nastran", path)
    assert np.allclose(found.positions, element.positions, rtol=1e-14)
    with pytest.raises(prs.PartFileError, match=r"part\.pch: is in mm-N-tonne-s, and 'units' says m-N-kg-s"):
        prs.read_part("nastran", path, units=SI)


def test_companions_in_other_units(tmp_path: Path) -> None:
    write(plain_element(), tmp_path / "part.op4", MM)
    write(plain_element(), tmp_path / "other.op4", SI)
    with pytest.raises(prs.PartFileError, match=r"other\.asm: is in m-N-kg-s, and part\.pch says mm-N-tonne-s"):
        prs.read_part("nastran", tmp_path / "part.op4", asm="other.asm")


def test_an_op4_does_not_replace_what_is_no_companion(tmp_path: Path) -> None:
    write(plain_element(), tmp_path / "part.pch")
    punched = (tmp_path / "part.pch").read_bytes()
    for _ in range(2):
        with pytest.raises(
            prs.PartFileError, match=r"part\.pch: would be replaced, but was not written beside part\.op4"
        ):
            write(plain_element(), tmp_path / "part.op4")
        assert (tmp_path / "part.pch").read_bytes() == punched
        (tmp_path / "part.op4").touch()  # of another export
    write(plain_element(), tmp_path / "again.op4")
    (tmp_path / "again.op4").unlink()
    write(plain_element(), tmp_path / "again.op4")
    (tmp_path / "alone.op4").write_bytes(b"of another program")
    with pytest.raises(prs.PartFileError, match=r"alone\.op4: is there already, and was not written by this program"):
        write(plain_element(), tmp_path / "alone.op4")
    (tmp_path / "foreign.pch").write_text("$ of another program\n")
    with pytest.raises(prs.PartFileError, match=r"foreign\.pch: is there already"):
        write(plain_element(), tmp_path / "foreign.pch")


def test_a_punch_does_not_replace_a_companion(tmp_path: Path) -> None:
    write(plain_element(), tmp_path / "part.op4")
    with pytest.raises(prs.PartFileError, match=r"would replace the companion of part\.op4"):
        write(plain_element(), tmp_path / "part.pch")
    with pytest.raises(prs.PartFileError, match="cannot be written"):
        write(plain_element(), tmp_path / "nowhere" / "part.op4")


def test_without_pyyeti(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A punch needs no library; an OP4 says which one it does."""
    monkeypatch.setitem(sys.modules, "pyyeti.nastran", None)
    write(plain_element(), tmp_path / "part.pch")
    with pytest.raises(prs.MissingExtraError, match=r"writing \.op4 needs the package 'pyyeti'.*prs-model\[nastran\]"):
        write(plain_element(), tmp_path / "other.op4")
    assert [path.name for path in tmp_path.iterdir()] == ["part.pch"]
