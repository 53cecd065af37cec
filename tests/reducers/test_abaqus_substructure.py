"""Substructures of Abaqus, written here as it lays them down, against the model that they are condensed from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

import prs_model as prs
from prs_model.reduction import SuperElement
from tests.meshes import box, steel
from tests.reducers.decks import changed, write_deck, write_user_element

UNITS = "mm-N-tonne-s"
MESH = box((0.4, 0.1, 0.06), (4, 1, 1))
MODEL = steel(MESH)
LABELS = 7 + 3 * np.random.default_rng(1).permutation(len(MESH.points))
ENDS = {"root": {"set": "Nx0"}, "tip": {"set": "Nx1"}}
# N/mm and t from N/m and kg
STIFFNESS, MASS = MODEL.stiffness.toarray() / 1e3, MODEL.mass.toarray() / 1e3
CORNERS = np.flatnonzero(np.all((MESH.points == 0.0) | (MESH.points == MESH.points.max(axis=0)), axis=1))


def condensed() -> tuple[np.ndarray, np.ndarray]:
    """Static condensation to the corners, in N/mm and t."""
    kept = MODEL.rows[CORNERS, :3].ravel()
    rest = np.setdiff1d(np.arange(MODEL.size), kept)
    follow = np.zeros((MODEL.size, len(kept)))
    follow[kept] = np.eye(len(kept))
    follow[rest] = -np.linalg.solve(STIFFNESS[np.ix_(rest, rest)], STIFFNESS[np.ix_(rest, kept)])
    stiffness, mass = (follow.T @ matrix @ follow for matrix in (STIFFNESS, MASS))
    return (stiffness + stiffness.T) / 2.0, (mass + mass.T) / 2.0


def substructure(folder: Path, *, with_mass: bool = True) -> Path:
    write_deck(folder / "job.inp", MESH, LABELS, scale=1e3)
    stiffness, mass = condensed()
    return write_user_element(folder / "job.mtx", stiffness, mass if with_mass else None, LABELS[CORNERS].tolist())


def test_a_substructure_is_a_super_element(tmp_path):
    element = prs.read_part("abaqus", substructure(tmp_path), units=UNITS)
    assert isinstance(element, SuperElement)
    element.check()
    properties, expected = element.mass_properties(), MODEL.mass_properties()
    assert properties.mass == pytest.approx(expected.mass, rel=1e-12)
    np.testing.assert_allclose(properties.centre, expected.centre, rtol=1e-10)
    np.testing.assert_allclose(properties.inertia, expected.inertia, atol=1e-10 * np.trace(expected.inertia))
    stiffness, mass = condensed()
    own = eigh(stiffness, mass, eigvals_only=True)[6:]
    np.testing.assert_allclose(eigh(element.stiffness, element.mass, eigvals_only=True)[6:], own, rtol=1e-9)
    assert set(element.node_sets["Nx0"]) == {str(LABELS[node]) for node in CORNERS if MESH.points[node, 0] == 0.0}
    held = prs.reduce("abaqus", tmp_path / "job.mtx", units=UNITS, interfaces=ENDS)
    assert held.mass_properties().mass == pytest.approx(expected.mass, rel=1e-9)


BAD_SUBSTRUCTURES = {
    "no mass": (lambda path: substructure(path.parent, with_mass=False), "ask for MASS=YES"),
    "two elements": (lambda path: path.write_text(path.read_text() * 2), "holds 2 elements, expected one substructure"),
    "truncated": (lambda path: path.write_text(path.read_text()[:-200]), r"MASS: found \d+ entries, expected 300"),
    "a node lost": (lambda path: changed(path, "NODES= 8", "NODES= 9"), "names 8 element nodes"),
    "unsymmetric": (lambda path: changed(path, ",LINEAR", ",LINEAR,UNSYMM"), "its matrices are unsymmetric"),
    "eigenmodes": (
        lambda path: changed(path, "** ELEMENT NODES\n** ", "** ELEMENT NODES\n** -"),
        "retained eigenmodes",
    ),
    "a dof of heat": (
        lambda path: changed(path, "\n1, 2, 3\n", "\n1, 2, 11\n"),
        "other than displacements and rotations",
    ),
    "no number": (lambda path: changed(path, "E+", "E+Q"), "expected a number"),
    "another deck": (
        lambda path: write_deck(path.with_suffix(".inp"), MESH, LABELS + 1000, scale=1e3),
        "8 of its nodes have no coordinates in job.inp",
    ),
}


@pytest.mark.parametrize("what", BAD_SUBSTRUCTURES)
def test_a_damaged_substructure_is_refused(tmp_path, what):
    damage, message = BAD_SUBSTRUCTURES[what]
    path = substructure(tmp_path)
    damage(path)
    with pytest.raises(prs.PartFileError, match=message):
        prs.read_part("abaqus", path, units=UNITS)


def test_swapped_nodes_of_a_substructure_are_seen_by_the_gate(tmp_path):
    path = substructure(tmp_path)
    first, second = (str(LABELS[node]) for node in CORNERS[:2])
    changed(path, f"** {first}, {second},", f"** {second}, {first},")
    with pytest.raises(prs.PhysicsError, match="rigid motion is free"):
        prs.reduce("abaqus", path, units=UNITS, interfaces=ENDS)
