"""Likeness of mode shapes: close modes may be turned and change places, and are still known."""

import dataclasses

import numpy as np
import pytest

import prs_model as prs
from prs_model.modes.mac import clusters, in_common, mac_of, observe, pairing, subspace_mac
from tests.verification.gantry import gantry

RNG = np.random.default_rng(4)
SHAPES = np.linalg.qr(RNG.normal(size=(60, 6)))[0]
FREQUENCIES = np.array([50.0, 50.2, 90.0, 120.0, 120.1, 200.0])


def turned(shapes: np.ndarray, i: int, j: int, angle: float) -> np.ndarray:
    """Shapes with two of them turned into each other."""
    result = shapes.copy()
    c, s = np.cos(angle), np.sin(angle)
    result[:, [i, j]] = shapes[:, [i, j]] @ np.array([[c, -s], [s, c]])
    return result


def test_a_shape_is_like_itself_whatever_its_size_and_sign():
    assert np.diag(mac_of(SHAPES, -3.0 * SHAPES)) == pytest.approx(np.ones(6))
    assert np.all(mac_of(SHAPES, np.zeros((60, 2))) == 0.0)


def test_mac_of_a_machine_is_that_of_its_points():
    """The hexapod's parts have no surface: their nodes are compared, and nothing else."""
    machine = prs.load_machine("hexapod")
    modes, moved = machine.modes(6), machine.modes(6, z=0.092)
    assert np.diag(prs.mac(modes, modes)) == pytest.approx(np.ones(6))
    found = prs.mac(modes, moved)
    assert found.shape == (6, 6)
    assert np.all((found >= 0.0) & (found <= 1.0 + 1e-12))
    assert found == pytest.approx(prs.mac(moved, modes).T)


def test_models_of_different_machines_are_not_compared(tmp_path):
    with pytest.raises(prs.PrsError, match="no surface points and no nodes in common"):
        prs.mac(prs.load_machine("hexapod").modes(2), gantry(tmp_path).modes(2))


def test_a_model_without_surfaces_is_compared_at_its_nodes(caplog):
    """The head against one whose platform has no surface, and one rod neither that nor the names of its nodes."""
    head = prs.load_machine("head_3prs").modes(4)
    elements = dict(head.system.elements)
    for body in ("platform", "rod_1"):
        elements[body] = dataclasses.replace(elements[body], surface=None)
    elements["rod_1"] = dataclasses.replace(
        elements["rod_1"], nodes=tuple(f"other {node}" for node in elements["rod_1"].nodes)
    )
    bare = dataclasses.replace(head, system=dataclasses.replace(head.system, elements=elements))
    assert np.diag(prs.mac(head, bare)) == pytest.approx(np.ones(4))
    assert "compared without rod_1: no points or nodes in common" in caplog.text
    shapes = [body["platform"].surface for body in (observe(head), observe(bare))]
    assert (len(shapes[0]) > 1000, len(shapes[1])) == (True, 0)
    assert len(in_common(*({"platform": observe(each)["platform"]} for each in (head, bare)))[0]) % 3 == 0


def test_as_many_points_are_not_the_same_points():
    """Points moved by a tenth of the body: nodes are compared instead."""
    head = prs.load_machine("head_3prs").modes(2)
    platform = head.system.elements["platform"]
    moved = dataclasses.replace(platform.surface, points=platform.surface.points + 0.1)
    other = dataclasses.replace(
        head,
        system=dataclasses.replace(head.system, elements={"platform": dataclasses.replace(platform, surface=moved)}),
    )
    mine = {"platform": observe(head)["platform"]}
    assert len(in_common(mine, mine)[0]) == platform.surface.points.size
    assert len(in_common(mine, observe(other))[0]) == 3 * len(platform.nodes)


def test_complex_modes_are_compared_as_real_ones():
    system = prs.load_machine("head_3prs").assemble()
    real, damped = system.modes(6), system.complex_modes(6, {"joints": {"R": {"loss_factor": 0.2}}})
    pairs = prs.pair_modes(damped, real)
    assert pairs.partners.tolist() == [0, 1, 2, 3, 4, 5]
    assert np.diag(pairs.mac) == pytest.approx(np.ones(6), abs=0.05)
    assert np.diag(prs.mac(damped, damped)) == pytest.approx(np.ones(6))
    assert prs.mac(damped, real) == pytest.approx(prs.mac(real, damped).T)


def test_pairs_of_a_machine_and_a_changed_one():
    """Pairs of equal frequency may turn at will: each alone is unlike, as pairs they are the same."""
    machine = prs.load_machine("hexapod")
    modes, moved = machine.modes(6), machine.replace({"joints.P_2.stiffness_factor": 1.0 + 1e-4}).modes(6)
    assert np.diag(prs.mac(modes, moved)).min() < 0.9
    pairs = prs.pair_modes(modes, moved)
    assert pairs.partners.tolist() == [0, 1, 2, 3, 4, 5]
    assert pairs.clusters.tolist() == [0, 0, 1, 2, 2, 3]
    assert np.diag(pairs.mac) == pytest.approx(np.ones(6), abs=1e-6)
    with pytest.raises(prs.PrsError, match="found 6 modes to pair with 3, expected as many at least"):
        prs.pair_modes(modes, machine.modes(3))


@pytest.mark.parametrize("wrong", [None, 3, np.eye(3)])
def test_what_is_no_modes_is_told(wrong):
    with pytest.raises(prs.PrsError, match="expected modes, such as"):
        prs.mac(prs.load_machine("hexapod").modes(2), wrong)


@pytest.mark.parametrize("angle", [0.3, np.pi / 4, 1.2, np.pi / 2])
def test_turned_pairs_of_close_modes_are_alike(angle):
    other = turned(turned(SHAPES, 0, 1, angle), 3, 4, -angle)
    found = pairing(SHAPES, other, FREQUENCIES, FREQUENCIES)
    assert np.diag(found.mac) == pytest.approx(np.ones(6))
    assert found.partners.tolist() == [0, 1, 2, 3, 4, 5]
    assert found.clusters.tolist() == [0, 0, 1, 2, 2, 3]
    assert min(np.diag(mac_of(SHAPES, other))) == pytest.approx(np.cos(angle) ** 2)


def test_modes_that_are_apart_are_not_turned():
    found = pairing(SHAPES, turned(SHAPES, 2, 5, 0.5), FREQUENCIES, FREQUENCIES)
    assert np.diag(found.mac)[[2, 5]] == pytest.approx(np.cos(0.5) ** 2)


def test_modes_that_change_places_keep_their_partners():
    order = [0, 1, 3, 4, 2, 5]
    found = pairing(SHAPES, SHAPES[:, order], FREQUENCIES, np.array([50.0, 50.2, 95.0, 95.1, 99.0, 200.0]))
    assert [order[partner] for partner in found.partners] == [0, 1, 2, 3, 4, 5]
    assert np.diag(found.mac) == pytest.approx(np.ones(6))


def test_close_in_either_model_is_close():
    apart = np.array([50.0, 51.0, 90.0, 120.0, 123.0, 200.0])
    found = pairing(SHAPES, turned(SHAPES, 3, 4, 0.7), apart, FREQUENCIES)
    assert np.diag(found.mac) == pytest.approx(np.ones(6))


def test_a_partner_may_lie_beyond_the_modes_asked_for():
    found = pairing(
        SHAPES[:, :3], SHAPES[:, [0, 1, 3, 4, 2]], FREQUENCIES[:3], np.array([50.0, 50.2, 80.0, 80.1, 91.0])
    )
    assert found.partners.tolist() == [0, 1, 4]


def test_the_cosine_to_a_cluster_is_that_to_its_nearest_shape():
    one = (SHAPES[:, :1] + SHAPES[:, 1:2] + SHAPES[:, 5:]) / np.sqrt(3.0)
    assert subspace_mac(one, SHAPES, clusters(FREQUENCIES))[0] == pytest.approx(
        [2 / 3, 2 / 3, 0, 0, 0, 1 / 3], abs=1e-12
    )
