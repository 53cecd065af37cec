"""Craig-Bampton with the boundary projected first, against slow and obvious twins on full matrices."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import prs_model as prs
from prs_model.description.schema import Interface
from prs_model.finite_elements import FiniteElementModel
from prs_model.reduction.coupling import Tie, averaging_matrix, rigid_rows
from prs_model.reduction.craig_bampton import craig_bampton
from prs_model.reduction.from_model import reduce_model, to_element
from prs_model.reduction.recipe import Settings
from tests.meshes import box, steel

SIZE = (0.4, 0.1, 0.08)
CORNER = {"box": {"x": (0.0, 0.0), "y": (0.0, 0.0), "z": (0.0, 0.0)}}


@pytest.fixture(scope="module")
def model() -> FiniteElementModel:
    return steel(box(SIZE, (5, 2, 1)))


def tie(model: FiniteElementModel, name: str, coupling: str, *, node: str | None = None) -> Tie:
    indices, weights = model.node_sets[name], model.set_weights[name]
    position = np.average(model.coordinates[indices], axis=0, weights=weights) + np.array([0.01, 0.02, -0.03])
    return Tie(node or name, indices, weights, position, coupling)


def dense(model: FiniteElementModel) -> tuple[np.ndarray, np.ndarray]:
    return model.stiffness.toarray(), model.mass.toarray()


def full_frequencies(model: FiniteElementModel, ties: list[Tie], count: int) -> np.ndarray:
    """Complete-order frequencies [Hz] of the free part whose rigid ties hold exactly; averaged ties change nothing."""
    stiffness, mass = dense(model)
    basis = np.eye(model.size)
    for each in ties:
        if each.coupling == "rigid":
            rows, block = rigid_rows(model, each)
            basis[rows] = 0.0
            basis = np.hstack([basis, np.zeros((model.size, 6))])
            basis[rows, -6:] = block
    basis = basis[:, np.any(basis != 0.0, axis=0)]
    values = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis, eigvals_only=True)
    return np.sqrt(np.abs(values[6 : 6 + count])) / (2.0 * np.pi)


def reduced_frequencies(stiffness: np.ndarray, mass: np.ndarray, count: int) -> np.ndarray:
    return np.sqrt(np.abs(eigh(stiffness, mass, eigvals_only=True)[6 : 6 + count])) / (2.0 * np.pi)


def test_boundary_first_equals_boundary_last(model):
    """The paper's order, all boundary DOF kept by Craig-Bampton and then tied by T, gives the same matrices."""
    ties, p = [tie(model, "x0", "rigid"), tie(model, "x1", "rigid")], 6
    rows, blocks = zip(*(rigid_rows(model, each) for each in ties), strict=True)
    boundary = np.concatenate(rows)
    interior = np.setdiff1d(np.arange(model.size), boundary)
    stiffness, mass = dense(model)
    inner, inner_mass = stiffness[np.ix_(interior, interior)], mass[np.ix_(interior, interior)]
    values, modes = eigh(inner, inner_mass, subset_by_index=[0, p - 1])
    statics = -np.linalg.solve(inner, stiffness[np.ix_(interior, boundary)])
    basis = np.zeros((model.size, len(boundary) + p))
    basis[boundary, : len(boundary)] = np.eye(len(boundary))
    basis[interior] = np.hstack([statics, modes])
    tied = np.zeros((len(boundary) + p, 12 + p))
    tied[: len(rows[0]), :6], tied[len(rows[0]) : len(boundary), 6:12] = blocks
    tied[len(boundary) :, 12:] = np.eye(p)
    found = craig_bampton(model, ties, p)
    signs = np.sign(np.einsum("ij,ij->j", found.basis[interior, 12:], inner_mass @ modes))
    tied[:, 12:] *= signs
    for full, reduced in ((stiffness, found.stiffness), (mass, found.mass)):
        expected = tied.T @ (basis.T @ full @ basis) @ tied
        scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        assert np.abs((reduced - expected) / scale).max() < 1e-10
    assert np.diag(found.stiffness)[12:] == pytest.approx(values, rel=1e-10)


@pytest.mark.parametrize("couplings", [("averaged", "averaged"), ("rigid", "averaged"), ("averaged", "rigid")])
def test_statics_are_exact(model, couplings):
    """Reduced stiffness against the bordered system of all constraints, solved densely; the part is free."""
    ties = [tie(model, name, coupling) for name, coupling in zip(("x0", "x1"), couplings, strict=True)]
    constraints = []
    for each in ties:
        if each.coupling == "averaged":
            constraints.append((averaging_matrix(model, each).toarray(), np.eye(6)))
        else:
            rows, block = rigid_rows(model, each)
            constraints.append((np.eye(model.size)[rows], block))
    held = np.vstack([matrix for matrix, _ in constraints])
    wanted = np.zeros((len(held), 12))
    wanted[: len(constraints[0][0]), :6], wanted[len(constraints[0][0]) :, 6:] = (block for _, block in constraints)
    scale = abs(model.stiffness).max()
    bordered = np.block([[model.stiffness.toarray(), scale * held.T], [scale * held, np.zeros((len(held),) * 2)]])
    solution = np.linalg.solve(bordered, np.vstack([np.zeros((model.size, 12)), scale * wanted]))
    energy = solution[: model.size].T @ (model.stiffness @ solution[: model.size])
    found = craig_bampton(model, ties, 2)
    assert np.abs(found.stiffness[:12, :12] - energy).max() < 1e-10 * np.abs(energy).max()
    assert found.basis[:, :12] == pytest.approx(solution[: model.size], abs=1e-9)


def test_modes_of_averaged_interfaces_are_exact(model):
    """Fixed-interface modes live in the null space of the averages."""
    ties = [tie(model, "x0", "averaged"), tie(model, "x1", "averaged")]
    free = null_space(np.vstack([averaging_matrix(model, each).toarray() for each in ties]))
    stiffness, mass = dense(model)
    values = eigh(free.T @ stiffness @ free, free.T @ mass @ free, eigvals_only=True, subset_by_index=[0, 4])
    found = craig_bampton(model, ties, 5)
    assert np.diag(found.stiffness)[12:] == pytest.approx(values, rel=1e-9)
    modes = found.basis[:, 12:]
    assert modes.T @ mass @ modes == pytest.approx(np.eye(5), abs=1e-10)
    assert averaging_matrix(model, ties[0]) @ modes == pytest.approx(np.zeros((6, 5)), abs=1e-8)


@pytest.mark.parametrize("coupling", ["rigid", "averaged"])
def test_frequencies_converge_from_above(model, coupling):
    ties = [tie(model, "x0", coupling), tie(model, "x1", coupling)]
    complete = full_frequencies(model, ties, 6)
    errors = []
    for p in (0, 2, 6, 20):
        reduction = craig_bampton(model, ties, p)
        errors.append(reduced_frequencies(reduction.stiffness, reduction.mass, 6) / complete - 1.0)
    assert all(np.all(error > -1e-9) for error in errors)
    assert all(np.all(more <= fewer + 1e-9) for fewer, more in pairwise(errors))
    assert errors[-1].max() < 6e-3


@pytest.mark.parametrize("coupling", ["rigid", "averaged"])
def test_a_reduced_part_is_the_same_rigid_body(model, coupling):
    ties = [tie(model, "x0", coupling), tie(model, "x1", coupling)]
    element = to_element(model, ties, craig_bampton(model, ties, 3), grounded=False)
    assert all(check.figure <= check.limit for check in element.check().checks)
    phi = element.rigid_body_modes()
    assert np.linalg.norm(element.stiffness @ phi) < 1e-11 * np.linalg.norm(element.stiffness) * np.linalg.norm(phi)
    assert np.abs(phi[12:]).max() < 1e-12
    full, reduced = model.mass_properties(), element.mass_properties()
    assert reduced.mass == pytest.approx(full.mass, rel=1e-10)
    assert reduced.centre == pytest.approx(full.centre, rel=1e-8)
    assert reduced.inertia == pytest.approx(full.inertia, rel=1e-8, abs=1e-10)


def test_reduction_is_the_same_every_time(model):
    ties = [tie(model, "x0", "rigid")]
    one, other = (craig_bampton(model, ties, 4) for _ in range(2))
    assert np.array_equal(one.mass, other.mass)
    modes = one.basis[:, 6:]
    assert np.all(modes[np.argmax(np.abs(modes) > 0.99 * np.abs(modes).max(axis=0), axis=0), np.arange(4)] > 0.0)


def test_a_grounded_part_is_held(model):
    clamped = model.clamp(["x0"])
    ends = {"end": Interface(set="x1", coupling="averaged")}
    element = reduce_model(clamped, ends, Settings("rigid", "joint", 2), grounded=True)
    element.check()
    with pytest.raises(prs.PhysicsError, match="if the part is held to the ground, say 'grounded: true'"):
        replace(element, grounded=False).check()


@pytest.mark.parametrize(
    ("interfaces", "modes", "words"),
    [
        ({}, 3, "has no interfaces"),
        ({"a": {"set": "x0"}, "b": {"set": "y0"}}, 3, r"a and b share \d+ nodes, the first at \(0, 0, 0\) m"),
        ({"a": {"set": "x0", "box": {"y": (0.0, 0.0)}}}, 3, "interface a: its .* nodes lie on one line"),
        ({"a": CORNER | {"coupling": "averaged"}}, 3, "interface a: its 1 nodes lie on one line"),
        (
            {"a": {"set": "x0"}, "b": {"set": "x0", "box": {"y": (0.0, 0.05)}, "coupling": "averaged"}},
            3,
            "interface b is averaged over nodes that a moves already",
        ),
        ({name: {"set": "x0", "coupling": "averaged"} for name in "ab"}, 3, "interface a is averaged over .*repeats b"),
        ({"a": {"nodes": (1,)}}, 3, "interfaces.a.nodes: its nodes have no labels .*name a set, a box or a cylinder"),
        ({"a": {"set": "x0"}}, 5000, "too few for 5000 modes"),
        ({"a": {"box": {}}}, 3, "found 0 inner DOFs, too few for 3 modes: its interfaces take all nodes"),
        ({"x0": {}}, 3, r"interfaces.x0: no nodes named, .*did you mean {set: x0}\?"),
        ({"a": {"node": 3}}, 3, "interfaces.a.nodes: its nodes have no labels"),
    ],
)
def test_interfaces_that_cannot_hold_are_explained(model, interfaces, modes, words):
    sections = {name: Interface.model_validate(entries) for name, entries in interfaces.items()}
    with pytest.raises(prs.PartFileError, match=words):
        reduce_model(model, sections, Settings("rigid", "joint", modes))


def test_a_part_in_two_pieces_is_noticed():
    model = twins()
    one, other = ({"set": "all", "box": {"x": (0.0, 0.0), "y": (low, low + 0.1)}} for low in (0.0, 1.0))
    far = one | {"box": {"x": (0.4, 0.4), "y": (0.0, 0.1)}}
    sets = {**model.node_sets, "all": np.arange(len(model.coordinates))}
    model = replace(model, node_sets=sets)
    for ends in (
        {"end": {"set": "x1"}},
        {"end": {"set": "x1", "coupling": "averaged"}},
        {"one": one, "other": other},
        {"one": one, "other": other, "far": far},
    ):
        interfaces = {name: Interface.model_validate(each) for name, each in ends.items()}
        with pytest.raises(prs.PhysicsError, match=r"found 2, allowed 1; .*share their nodes"):
            reduce_model(model, interfaces, Settings("rigid", "joint", 2))


def twins() -> FiniteElementModel:
    """Two equal boxes that share no node."""
    mesh = box(SIZE, (3, 1, 1))
    points = np.concatenate([mesh.points, mesh.points + np.array([0.0, 1.0, 0.0])])
    return steel(
        replace(mesh, points=points, elements=np.concatenate([mesh.elements, mesh.elements + len(mesh.points)]))
    )


def test_pieces_that_a_rigid_interface_joins_are_one_part():
    model = twins()
    across = Interface.model_validate({"box": {"x": (0.0, 0.0)}})
    element = reduce_model(model, {"across": across}, Settings("rigid", "joint", 2))
    element.check()
    assert element.mass_properties().mass == pytest.approx(model.mass_properties().mass)


def test_half_a_pair_of_modes_is_noted(caplog):
    across = {"across": Interface.model_validate({"box": {"x": (0.0, 0.0)}})}
    with caplog.at_level("WARNING", logger="prs_model"):
        reduce_model(twins(), across, Settings("rigid", "joint", 2))
        assert not caplog.text
        reduce_model(twins(), across, Settings("rigid", "joint", 1))
    assert "its modes 1 and 2 are a pair" in caplog.text


def test_members_are_tied_together_or_one_by_one(model):
    rail = {
        "members": (
            {"name": "left", "set": "z1", "box": {"y": (0.0, 0.03)}, "at": (0.1, 0.0, 0.08)},
            {"name": "right", "set": "z1", "box": {"y": (0.07, 0.1)}},
        ),
        "at": (0.2, 0.05, 0.08),
    }
    together = reduce_model(model, {"rail": Interface.model_validate(rail)}, Settings("averaged", "joint", 1))
    apart = reduce_model(model, {"rail": Interface.model_validate(rail)}, Settings("averaged", "interface", 1))
    assert together.nodes == ("rail",)
    assert together.positions[0] == pytest.approx([0.2, 0.05, 0.08])
    assert apart.nodes == ("rail.left", "rail.right")
    assert apart.positions == pytest.approx(np.array([[0.1, 0.0, 0.08], [0.2, 0.0875, 0.08]]), abs=0.01)
    assert apart.labels[:2] == ("rail.left.ux", "rail.left.uy")
    assert apart.labels[-1] == "mode 1"


def test_members_named_in_different_ways_weigh_by_their_areas(model):
    """Half the end by its set, half by a box round it: the centre is the end's, to a row of nodes."""
    halves = (
        {"name": "low", "set": "x0", "box": {"y": (0.0, 0.049)}},
        {"name": "high", "box": {"x": (0.0, 0.0), "y": (0.051, 0.1)}},
    )
    for members in (halves, halves[::-1]):
        end = Interface.model_validate({"members": members})
        element = reduce_model(model, {"end": end}, Settings("averaged", "joint", 0))
        assert element.positions[0] == pytest.approx([0.0, 0.05, 0.04], abs=0.01)


def test_without_areas_all_nodes_weigh_the_same(model):
    bare = replace(model, areas=None)
    halves = (
        {"name": "low", "set": "x0", "box": {"y": (0.0, 0.049)}},
        {"name": "high", "box": {"x": (0.0, 0.0), "y": (0.051, 0.1)}},
    )
    end = Interface.model_validate({"members": halves})
    element = reduce_model(bare, {"end": end}, Settings("averaged", "joint", 0))
    assert element.positions[0] == pytest.approx([0.0, 0.05, 0.04], abs=0.001)


def test_a_surprising_selection_is_noted(model, caplog):
    """Most of the part held as one rigid body, and a node in millimetres."""
    reduce_model(model, {"a": Interface(set="x0")}, Settings("rigid", "joint", 1))
    assert not caplog.records
    most = Interface(box={"x": (0.1, 0.4)})
    reduce_model(model, {"a": most}, Settings("rigid", "joint", 1))
    assert re.search(
        r"interface a holds \d+ of the part's \d+ nodes as one rigid body; select its seat only", caplog.text
    )
    reduce_model(model, {"a": Interface(set="x0", at=(0.0, 50.0, 40.0))}, Settings("rigid", "joint", 1))
    assert "interface a stands at (0, 50, 40) m, 63.9 m from the nodes it ties; the part reaches from" in caplog.text


def test_a_negative_mass_is_refused():
    model = steel(box((0.4, 0.1, 0.08), (3, 1, 1)))
    negative = replace(model, mass=-1.0 * model.mass)
    with pytest.raises(prs.PhysicsError, match="mass is not negative"):
        reduce_model(negative, {"a": Interface(set="x0")}, Settings("rigid", "joint", 2))
