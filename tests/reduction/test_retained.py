"""Interfaces of a part that comes reduced: several of its nodes tied to a new one, as a full model's would be."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.sparse import csr_array

import prs_model as prs
from prs_model.description.schema import Interface, Member
from prs_model.description.units import SI
from prs_model.finite_elements.rigid_motion import transfer
from prs_model.linear_algebra import lowest_modes
from prs_model.part_files import LabelledMatrices, NodeTable, super_element
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
from prs_model.reduction.retained import at_interfaces
from tests.meshes import box, steel

RIGID, AVERAGED = Settings("rigid", "joint", 0), Settings("averaged", "joint", 0)


@pytest.fixture(scope="module")
def element() -> prs.SuperElement:
    """A steel block whose every DOF is kept: the corners of its ends have three translations each."""
    model = steel(box((0.4, 0.1, 0.08), (3, 1, 1)))
    matrices = LabelledMatrices(Path("block"), model.stiffness, model.mass, model.dofs[:, 0], model.dofs[:, 1])
    nodes = NodeTable(Path("block"), np.arange(len(model.coordinates)), model.coordinates)
    sets = {name: tuple(map(str, model.node_sets[name])) for name in ("x0", "x1")}
    return super_element(matrices, nodes, SI, node_sets=sets)


def frequencies(element: prs.SuperElement, count: int = 10) -> np.ndarray:
    return lowest_modes(element.mass, element.stiffness, count)[0][6:] ** 0.5 / (2.0 * np.pi)


def held(element: prs.SuperElement, nodes: tuple[str, ...]) -> np.ndarray:
    """The six lowest frequencies with these nodes held."""
    motions = [element.motions[element.node(node)] for node in nodes]
    inner = null_space(np.concatenate(motions))
    mass, stiffness = (inner.T @ matrix @ inner for matrix in (element.mass, element.stiffness))
    return lowest_modes(mass, stiffness, 6)[0] ** 0.5 / (2.0 * np.pi)


@pytest.mark.parametrize("settings", [RIGID, AVERAGED], ids=["rigid", "averaged"])
def test_ties_are_those_of_a_full_model(element, settings):
    """Held at its interfaces, the part has the fixed-interface frequencies that our own reduction finds."""
    interfaces = {"root": Interface(set="x0"), "tip": Interface(set="x1", at=(0.4, 0.05, 0.04))}
    tied = at_interfaces(element, interfaces, settings, "block")
    tied.check()
    model = steel(box((0.4, 0.1, 0.08), (3, 1, 1)))
    model = replace(model, set_weights={}, areas=None)
    ours = reduce_model(model, interfaces, Settings(settings.coupling, "joint", 6))
    assert held(tied, ("root", "tip")) == pytest.approx(np.sqrt(np.diag(ours.stiffness)[12:]) / (2 * np.pi), rel=1e-7)
    assert tied.mass_properties().mass == pytest.approx(ours.mass_properties().mass)
    assert set(tied.nodes) >= {"root", "tip"}


def test_a_rigid_tie_replaces_coordinates_and_an_averaged_one_adds_none(element):
    chosen = {"root": Interface(box={"x": (-0.01, 0.01)})}
    rigid = at_interfaces(element, chosen, RIGID, "block")
    assert rigid.size == element.size - 3 * len(element.node_sets["x0"]) + 6
    assert rigid.labels[:2] == ("root.ux", "root.uy")
    assert frequencies(rigid)[0] > frequencies(element)[0]
    averaged = at_interfaces(element, chosen, AVERAGED, "block")
    assert averaged.size == element.size
    assert frequencies(averaged) == pytest.approx(frequencies(element))


def test_members_get_nodes_of_their_own(element):
    members = (Member(name="a", set="x0"), Member(name="b", set="x1"))
    apart = at_interfaces(element, {"ends": Interface(members=members, tie="interface")}, RIGID, "block")
    assert apart.nodes[:2] == ("ends.b", "ends.a")
    together = at_interfaces(element, {"ends": Interface(members=members)}, RIGID, "block")
    assert together.nodes[0] == "ends"
    ends = np.isin(element.nodes, element.node_sets["x0"] + element.node_sets["x1"])
    assert together.positions[0] == pytest.approx(element.positions[ends].mean(axis=0), abs=1e-12)


@pytest.fixture(scope="module")
def angle() -> prs.SuperElement:
    """A bent bar with six DOFs at each of four nodes, three of them on a line, in turned output frames."""
    nodes = {"a": (0.0, 0.0, 0.0), "b": (0.1, 0.0, 0.0), "c": (0.2, 0.0, 0.0), "d": (0.2, 0.1, 0.0)}
    section = {"kind": "rectangle", "y": 0.02, "z": 0.03, "material": {"E": 2.1e11, "nu": 0.3, "density": 7850.0}}
    members = [{"between": tuple(ends), "section": "bar", "elements": 1} for ends in ("ab", "bc", "cd")]
    model = prs.read_part("beam", nodes=nodes, sections={"bar": section}, members=members)
    turned = np.array([[0.6, 0.8, 0.0], [0.8, -0.6, 0.0], [0.0, 0.0, -1.0]])
    frames = np.kron(np.eye(8), turned)
    stiffness, mass = (csr_array(frames.T @ matrix.toarray() @ frames) for matrix in (model.stiffness, model.mass))
    matrices = LabelledMatrices(Path("angle"), stiffness, mass, model.dofs[:, 0], model.dofs[:, 1])
    return super_element(
        matrices, NodeTable(Path("angle"), np.arange(4), model.coordinates, np.array([turned] * 4)), SI
    )


@pytest.mark.parametrize(
    ("nodes", "settings"), [((0, 1, 2, 3), AVERAGED), ((2,), AVERAGED), ((0, 1, 2), RIGID), ((0, 3), RIGID)]
)
def test_a_tie_of_nodes_with_rotations_moves_as_the_part_does(angle, nodes, settings):
    """In every rigid motion, turns included; one node alone is held, whatever the coupling."""
    tied = at_interfaces(angle, {"tip": Interface(nodes=nodes, at=(0.1, 0.1, 0.1))}, settings, "angle")
    tied.check()
    tip = tied.node("tip")
    assert tied.motions[tip] @ tied.rigid_body_modes() == pytest.approx(transfer([0.1, 0.1, 0.1]), abs=1e-9)
    assert np.linalg.matrix_rank(tied.motions[tip]) == 6


def test_translations_on_a_line_are_no_average_of_a_turn(angle):
    with pytest.raises(prs.PartFileError, match=r"interfaces\.tip: its 3 nodes lie on one line"):
        at_interfaces(angle, {"tip": Interface(nodes=(0, 1, 2))}, AVERAGED, "angle")


def test_the_order_of_interfaces_does_not_matter(element):
    """Rigid and averaged over nodes of which some are shared: the same part either way round."""
    both = {"root": Interface(set="x0"), "body": Interface(nodes=(0, 5, 6, 9, 10), coupling="averaged")}
    one, other = (at_interfaces(element, dict(each), RIGID, "block") for each in (both.items(), reversed(both.items())))
    assert one.nodes == other.nodes
    assert one.motions == pytest.approx(other.motions, abs=1e-12)
    assert frequencies(one) == pytest.approx(frequencies(other), rel=1e-9)


def test_a_node_far_from_the_part_is_noted(element, caplog):
    at_interfaces(element, {"tip": Interface(set="x1", at=(0.4, 0.05, 0.3))}, RIGID, "block")
    assert not caplog.records
    at_interfaces(element, {"tip": Interface(set="x1", at=(3.0, 0.05, 0.04))}, RIGID, "block")
    assert "block: interface tip stands at (3, 0.05, 0.04) m, 2.6 m from the nodes it ties; the part" in caplog.text


def test_a_word_is_a_set_or_else_a_node(angle, element):
    interfaces = {"a": Interface.model_validate("2"), "d": Interface.model_validate(3)}
    assert at_interfaces(angle, interfaces, RIGID, "angle").nodes == ("0", "1", "a", "d")
    by_set = at_interfaces(element, {"root": Interface.model_validate("x0")}, RIGID, "block")
    assert by_set.size == at_interfaces(element, {"root": Interface(set="x0")}, RIGID, "block").size
    with pytest.raises(
        prs.PartFileError, match=r"a: found 'left', which is neither a node set \(none\) nor a node \(0, 1"
    ):
        at_interfaces(angle, {"a": Interface.model_validate("left")}, RIGID, "angle")


@pytest.mark.parametrize(
    ("interfaces", "words"),
    [
        ({"tip": {"node": 3}}, r"node '3' has ux, uy, uz only, .* name three or more nodes as 'nodes'"),
        ({"tip": {"nodes": (3,)}}, "1 nodes lie on one line"),
        ({"tip": {"set": "x2"}}, "found node set 'x2', expected one of x0, x1"),
        ({"tip": {"nodes": (3, 4000)}}, "found node '4000', expected a node of the part"),
        ({"tip": {"plane": {"point": (9.0, 0.0, 0.0), "normal": (1.0, 0.0, 0.0), "tolerance": 0.01}}}, "plane 0"),
        ({"tip": {"set": "x0"}, "other": {"set": "x0"}}, "interfaces tip and other share node '0'"),
        ({"tip": {"set": "x0"}, "other": {"set": "x0", "coupling": "averaged"}}, "moves already, so it repeats tip"),
        ({"tip": {"set": "x0", "coupling": "averaged"}, "other": {"set": "x0"}}, "moves already, so it repeats other"),
    ],
)
def test_what_cannot_be_tied_is_explained(element, interfaces, words):
    sections = {name: Interface.model_validate(each) for name, each in interfaces.items()}
    with pytest.raises(prs.PartFileError, match=words):
        at_interfaces(element, sections, RIGID, "block")
