"""Likeness of mode shapes: close modes may be turned and change places, and are still known."""

import numpy as np
import pytest

import prs_model as prs
from prs_model.modes.mac import clusters, mac_of, pairing, subspace_mac
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
