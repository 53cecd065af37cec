"""Keyword decks: what solids enclose, sets, surfaces, includes, moved instances, and words about what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_reducers.meshes.deck_mesh import read_deck_mesh
from prs_reducers.meshes.labelled_mesh import LabelledMesh
from prs_reducers.meshes.part_mesh import mesh_files
from prs_reducers.meshes.solid_faces import EDGES, outer_surface

TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
WEDGE = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
BRICK = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
ROOT = np.sqrt(2.0)
# corners, type, volume and surface of the unit solids
SOLIDS = [
    (TETRAHEDRON, "C3D4", 1 / 6, 1.5 + np.sqrt(3.0) / 2),
    (TETRAHEDRON, "C3D10M", 1 / 6, 1.5 + np.sqrt(3.0) / 2),
    (WEDGE, "C3D6", 1 / 2, 3.0 + ROOT),
    (WEDGE, "C3D15", 1 / 2, 3.0 + ROOT),
    (BRICK, "C3D8I", 1.0, 6.0),
    (BRICK, "C3D20R", 1.0, 6.0),
]


def deck(folder: Path, text: str, name: str = "part.inp") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def nodes(points: object, first: int = 1) -> str:
    return "*NODE\n" + "".join(
        f"{label}, {x}, {y}, {z}\n" for label, (x, y, z) in enumerate(np.array(points).tolist(), start=first)
    )


def volume(mesh: LabelledMesh) -> float:
    """By the divergence theorem, so positive only when all triangles are seen from outside."""
    triangles = outer_surface(mesh.solids, mesh.table.coordinates).triangles
    a, b, c = np.moveaxis(mesh.table.coordinates[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize(("corners", "kind", "size", "area"), SOLIDS)
def test_the_outer_surface_encloses_the_solid(tmp_path, corners, kind, size, area):
    points = np.array(corners, dtype=float) + np.array([2.0, 3.0, 4.0])
    if kind[3:5].strip("IRM") not in ("4", "6", "8"):
        points = np.vstack([points, [(points[a] + points[b]) / 2 for a, b in EDGES[len(corners)]]])
    labels = [str(label) for label in range(1, len(points) + 1)]
    element = ", ".join(["7", *labels[:15]]) + (",\n" + ", ".join(labels[15:]) if labels[15:] else "")
    mesh = read_deck_mesh(deck(tmp_path, f"{nodes(points)}*ELEMENT, TYPE={kind}\n{element}\n"))
    assert volume(mesh) == pytest.approx(size, rel=1e-12)
    surface = outer_surface(mesh.solids, mesh.table.coordinates)
    assert surface.areas.sum() == pytest.approx(area, rel=1e-12)
    assert (surface.mid_sides is None) == (kind in ("C3D15", "C3D20R"))
    if kind == "C3D10M":
        corners = mesh.table.coordinates[surface.triangles]
        halfway = (corners + np.roll(corners, -1, axis=1)) / 2.0
        np.testing.assert_allclose(mesh.table.coordinates[surface.mid_sides], halfway, rtol=1e-12)


def test_faces_between_elements_are_inside(tmp_path):
    points = [*BRICK, *([x + 1, y, z] for x, y, z in (BRICK[1], BRICK[2], BRICK[5], BRICK[6]))]
    elements = "*ELEMENT, TYPE=C3D8\n1, 1,2,3,4,5,6,7,8\n2, 2,9,10,3,6,11,12,7\n"
    mesh = read_deck_mesh(deck(tmp_path, nodes(points) + elements))
    assert volume(mesh) == pytest.approx(2.0)
    assert outer_surface(mesh.solids, mesh.table.coordinates).areas.sum() == pytest.approx(10.0)


SETS = """*Part, name=Block
{nodes}*Element, type=C3D8, elset=All
 1, 1,2,3,4,5,6,7,8
*Nset, nset=Base, generate
 1, 4, 1
*End Part
*Assembly, name=Assembly
*Instance, name=Block-1, part=Block
 10., 0., 0.
 10., 0., 0., 10., 0., 1., 90.
*End Instance
*Nset, nset=Tip, instance=Block-1
 5, 6, Block-1.7
*Nset, nset=Both
 Base, tip
*Nset, nset=OfElements, elset=ALL
*Elset, elset=_Top_S2, internal, instance=Block-1
 1
*Surface, type=ELEMENT, name=Top
_Top_S2, S2
*End Assembly
"""


def test_sets_surfaces_and_a_moved_instance(tmp_path):
    """The brick is shifted by 10 along x, then turned a quarter about the vertical through (10, 0)."""
    mesh = read_deck_mesh(deck(tmp_path, SETS.format(nodes=nodes(BRICK))))
    named = {name: mesh.table.labels[members].tolist() for name, members in mesh.node_sets.items()}
    assert named == {
        "Base": [1, 2, 3, 4], "Tip": [5, 6, 7], "Both": [1, 2, 3, 4, 5, 6, 7], "OfElements": [*range(1, 9)],
        "All": [*range(1, 9)],
    }  # fmt: skip
    ((corners, middles),) = mesh.surfaces["Top"]
    assert (np.sort(corners).tolist(), middles.size) == ([[4, 5, 6, 7]], 0)
    turned = [[10.0 - y, x, z] for x, y, z in BRICK]
    np.testing.assert_allclose(mesh.table.coordinates, turned, atol=1e-12)


TWO_BRICKS = nodes([*BRICK, *([x + 1, y, z] for x, y, z in (BRICK[1], BRICK[2], BRICK[5], BRICK[6]))]) + (
    "*ELEMENT, TYPE=C3D8, ELSET=Left\n1, 1,2,3,4,5,6,7,8\n*ELEMENT, TYPE=C3D8\n2, 2,9,10,3,6,11,12,7\n"
)


def test_a_surface_without_face_labels_is_all_that_is_free(tmp_path):
    """The left one of two bricks shares a face with the other, and five are free."""
    mesh = read_deck_mesh(deck(tmp_path, TWO_BRICKS + "*SURFACE, NAME=Skin\nLeft,\n*SURFACE, NAME=One\n2\nLeft, s1\n"))
    skin, one = (np.concatenate([corners for corners, _ in mesh.surfaces[name]]) for name in ("Skin", "One"))
    inner = {1, 2, 5, 6}
    assert len(skin) == 5
    assert len(one) == 6
    assert inner not in [set(face) for face in skin.tolist()]
    assert sorted(one[-1].tolist()) == [0, 1, 2, 3]


def test_a_surface_of_nodes_is_a_set(tmp_path):
    mesh = read_deck_mesh(deck(tmp_path, TWO_BRICKS + "*SURFACE, NAME=Pins, TYPE=NODE\n5, 1.5\n7,\n"))
    assert mesh.table.labels[mesh.node_sets["Pins"]].tolist() == [5, 7]


@pytest.mark.parametrize(
    ("name", "held"), [("XSYMM", [0, 4, 5]), ("zasymm", [0, 1, 5]), ("ENCASTRE", [*range(6)]), ("2, 3", [1, 2])]
)
def test_boundary_conditions_have_names(tmp_path, name, held):
    mesh = read_deck_mesh(deck(tmp_path, TWO_BRICKS + f"*BOUNDARY\n3, {name}\n"))
    assert mesh.held is not None
    assert mesh.held.tolist() == [[2, component] for component in held]


def test_a_full_line_goes_on_without_a_comma(tmp_path):
    points = np.vstack([BRICK, [(np.array(BRICK[a]) + BRICK[b]) / 2 for a, b in EDGES[8]]])
    rows = "7, " + ", ".join(map(str, range(1, 16))) + "\n16, 17, 18, 19, 20\n"
    mesh = read_deck_mesh(deck(tmp_path, nodes(points) + "*ELEMENT, TYPE=C3D20R\n" + rows))
    assert volume(mesh) == pytest.approx(1.0)


LIGHT = """*ELEMENT, TYPE=S4R, ELSET=Shell
1, 1,2,3,4
*ELEMENT, TYPE=S4R, ELSET=Skin
2, 5,6,7,8
*ELEMENT, TYPE=SPRINGA, ELSET=Spring
3, 1,9
*SHELL SECTION, ELSET=Shell, MATERIAL=Steel
1.,
*SHELL SECTION, ELSET=Skin, MATERIAL=Foil
1.,
*MATERIAL, NAME=STEEL
*DENSITY
7.85e-9
*MATERIAL, NAME=FOIL
*ELASTIC
210000., 0.3
"""


def test_elements_with_mass_are_told_from_those_without(tmp_path):
    mesh = read_deck_mesh(deck(tmp_path, nodes([*BRICK, [5, 5, 5]]) + LIGHT))
    assert mesh.table.labels[mesh.weighing].tolist() == [1, 2, 3, 4]


def test_included_files_are_read_and_named(tmp_path):
    (tmp_path / "mesh").mkdir()
    inner = deck(tmp_path / "mesh", "*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1,2,3,4\n", "elements.inc")
    outer = deck(
        tmp_path, nodes(TETRAHEDRON) + '*Include, input="mesh/elements.inc"\n*BOUNDARY\nE1, 1, 3\n'.replace("E1", "1")
    )
    mesh = read_deck_mesh(outer)
    assert mesh_files(outer) == (outer, inner)
    assert mesh.node_sets["E"].tolist() == [0, 1, 2, 3]
    assert mesh.held is not None
    assert mesh.held.tolist() == [[0, 0], [0, 1], [0, 2]]


BAD = {
    "Dear colleague,\n": "line 1: found 'Dear colleague,' before any keyword",
    "*HEADING\nno nodes\n": "has no \\*NODE in it",
    "*NODE\n1, 0, O, 0\n": "line 2: \\*NODE: found 'O', expected a number",
    "*NODE\none, 0, 0, 0\n": "line 2: \\*NODE: found 'one', expected a whole number",
    "*NODE\n1, 0, 0, 0\n1, 1, 0, 0\n": "line 3: node 1 is defined twice",
    "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n": "line 4: element 1 has node 2, which the deck does not",
    "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1\n": "line 4: found 3 nodes, expected 4 for C3D4",
    "*NODE\n1, 0, 0, 0\n*ELEMENT\n1, 1\n": "line 3: \\*ELEMENT without TYPE=",
    "*NODE\n1, 0, 0, 0\n*NSET, NSET=A\nB\n": "line 4: \\*NSET: found set 'B', which the deck does not define before",
    "*NODE\n1, 0, 0, 0\n*NSET, NSET=A, GENERATE\n4, 1\n": "line 4: \\*NSET: found 4, 1, expected first, last and step",
    "*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=part.inp\n": "\\*INCLUDE of part.inp, which includes it: a circle",
    "*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=lost.inc\n": "line 3: \\*INCLUDE of lost.inc: there is no such file",
    "*INSTANCE, NAME=A\n*INSTANCE, NAME=B\n*NODE\n1, 0, 0, 0\n": "line 2: a second \\*INSTANCE; .*merge",
    "*SYSTEM\n10., 0., 0.\n*NODE\n1, 0, 0, 0\n": "line 1: \\*SYSTEM is not read: write all nodes",
    "*NODE\n1, 0, 0, 0\n*NGEN\n1, 9, 2\n": "line 3: \\*NGEN is not read: write all nodes and elements out",
    "*NODE, INPUT=nodes.txt\n": "line 1: \\*NODE, INPUT= is not read: use \\*INCLUDE",
    "*NODE\n1, 0, 0, 0\n*TRANSFORM, NSET=99999\n1,0,0,0,1,0\n": "line 3: \\*TRANSFORM: found node 99999, which",
    f"{TWO_BRICKS}*SURFACE, NAME=S\nLeft, SPOS\n": "line 19: .*found side 'SPOS' of element 1, a solid; expected S1",
    "*NODE, SYSTEM=C\n1, 1, 90, 0\n": "SYSTEM=C or S is not read: write rectangular coordinates",
}


@pytest.mark.parametrize("text", BAD)
def test_what_is_wrong_is_said_with_its_line(tmp_path, text):
    with pytest.raises(prs.PartFileError, match=BAD[text]) as error:
        read_deck_mesh(deck(tmp_path, text))
    assert "part.inp" in str(error.value)
