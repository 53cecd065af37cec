"""Node tags of gmsh's files, in every form of the format, and labels of decks name the nodes of a solid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.finite_elements import FiniteElementModel
from prs_reducers.meshes.gmsh_labels import node_labels
from tests.meshes import STEEL, box, write
from tests.reducers.decks import write_deck

FIRST = 1001


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bar in four forms of .msh and a table of its tags; gmsh writes those of 4.1-0 from 1001 on, others from 1."""
    pytest.importorskip("gmsh", reason="gmsh meshes the bar", exc_type=(ImportError, OSError))
    from prs_machines.head_3prs.gmsh_solids import box as block
    from prs_machines.head_3prs.gmsh_solids import model

    folder = tmp_path_factory.mktemp("msh")
    with model("bar", 20.0) as gmsh:
        block(gmsh, (0.0, 60.0), (0.0, 10.0), (0.0, 12.0))
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        for binary, first in ((1, 1), (0, FIRST)):
            old = np.sort(gmsh.model.mesh.getNodes()[0])
            gmsh.model.mesh.renumberNodes(old, np.arange(len(old)) + first)
            gmsh.option.setNumber("Mesh.Binary", binary)
            for version in (2.2, 4.1):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.write(str(folder / f"{version}-{binary}.msh"))
        tags, places, _ = gmsh.model.mesh.getNodes()
    np.savez(folder / "nodes.npz", tags=tags, places=places.reshape(-1, 3) / 1e3)
    return folder


@pytest.mark.parametrize("form", ["2.2-0", "4.1-0", "2.2-1", "4.1-1"])
def test_every_tag_is_where_gmsh_put_it(folder, form):
    found = prs.read_part("solid", folder / f"{form}.msh", units="mm-N-tonne-s", material=STEEL)
    assert isinstance(found, FiniteElementModel)
    assert found.node_ids is not None
    nodes = np.load(folder / "nodes.npz")
    shift = 0 if form == "4.1-0" else FIRST - 1
    place = dict(zip(nodes["tags"].tolist(), nodes["places"], strict=True))
    expected = [place[tag + shift] for tag in found.node_ids.tolist()]
    np.testing.assert_allclose(found.coordinates, expected, atol=1e-15)


def test_nodes_of_a_solid_are_an_interface_by_their_tags(folder):
    nodes = np.load(folder / "nodes.npz")
    end = nodes["tags"][np.abs(nodes["places"][:, 0]) < 1e-9]
    options = {"units": "mm-N-tonne-s", "material": STEEL, "modes": 2}
    part = folder / "4.1-0.msh"
    element = prs.reduce("solid", part, nodes={"root": [int(tag) for tag in end]}, **options)
    np.testing.assert_allclose(element.positions[0, 0], 0.0, atol=1e-12)
    with pytest.raises(prs.PartFileError, match="found node '5', expected a node of the part"):
        prs.reduce("solid", part, nodes={"root": [5]}, **options)


def test_labels_are_given_only_for_the_coordinates_of_the_file(tmp_path):
    mesh = box((0.3, 0.1, 0.1), (2, 1, 1))
    path = write(mesh, tmp_path / "box.msh")
    assert node_labels(path, mesh.points) is not None
    assert node_labels(path, mesh.points[::-1]) is None
    path.write_bytes(path.read_bytes()[:300])
    assert node_labels(path, mesh.points) is None


def test_labels_of_a_deck_name_the_nodes_of_a_solid(tmp_path):
    mesh = box((0.3, 0.1, 0.1), (2, 1, 1))
    labels = 500 - 3 * np.arange(len(mesh.points))
    found = prs.read_part("solid", write_deck(tmp_path / "box.inp", mesh, labels), units="m-N-kg-s", material=STEEL)
    assert isinstance(found, FiniteElementModel)
    assert found.node_ids is not None
    at = dict(zip(labels.tolist(), mesh.points, strict=True))
    np.testing.assert_allclose(found.coordinates, [at[label] for label in found.node_ids.tolist()], atol=1e-15)


def test_a_deck_that_moves_its_nodes_is_no_solid_elsewhere(tmp_path):
    """meshio reads it without a word as if *SYSTEM were not there."""
    deck = write_deck(tmp_path / "box.inp", (mesh := box((0.3, 0.1, 0.1), (2, 1, 1))), np.arange(len(mesh.points)) + 1)
    deck.write_text("*SYSTEM\n1., 0., 0.\n" + deck.read_text())
    with pytest.raises(prs.PartFileError, match=r"line 1: \*SYSTEM is not read: write all nodes and elements out"):
        prs.read_part("solid", deck, units="m-N-kg-s", material=STEEL)
