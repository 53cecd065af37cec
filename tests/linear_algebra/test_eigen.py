"""The eigenproblem on pencils with known answers: singular mass, rigid-body modes, repeated roots, nothing held."""

import numpy as np
import pytest
from scipy.linalg import eigh

from prs_model.errors import PrsError
from prs_model.modes import lowest_modes


def chain(masses: list[float], springs: list[float], grounded: bool) -> tuple[np.ndarray, np.ndarray]:
    n = len(masses)
    stiffness = np.zeros((n, n))
    for k, spring in enumerate(springs):
        ends = [k - 1, k] if grounded else [k, k + 1]
        for i in ends:
            for j in ends:
                if min(i, j) >= 0:
                    stiffness[i, j] += spring if i == j else -spring
    return np.diag(masses), stiffness


def test_agrees_with_the_plain_eigensolver() -> None:
    generator = np.random.default_rng(5)
    a, b = generator.normal(size=(2, 30, 30))
    scale = np.diag(10.0 ** generator.uniform(-3, 3, size=30))
    mass = scale @ (a @ a.T + np.eye(30)) @ scale
    stiffness = 1e6 * scale @ (b @ b.T + np.eye(30)) @ scale
    values, shapes = lowest_modes(mass, stiffness, 6)
    np.testing.assert_allclose(values, eigh(stiffness, mass, eigvals_only=True)[:6], rtol=1e-9)
    np.testing.assert_allclose(shapes.T @ mass @ shapes, np.eye(6), atol=1e-9)
    np.testing.assert_allclose(shapes.T @ stiffness @ shapes, np.diag(values), rtol=1e-9, atol=1e-9 * values.max())


def test_massless_coordinates_are_condensed() -> None:
    """Two springs in series through a massless node carry one mass at half the stiffness: one mode, not two."""
    mass, stiffness = chain([0.0, 2.0], [100.0, 100.0], grounded=True)
    values, _ = lowest_modes(mass, stiffness, 5)
    np.testing.assert_allclose(values, [50.0 / 2.0], rtol=1e-12)


def test_free_chain_has_a_rigid_body_mode_and_the_reduced_mass_frequency() -> None:
    mass, stiffness = chain([1.0, 3.0], [12.0], grounded=False)
    values, _ = lowest_modes(mass, stiffness, 2)
    assert abs(values[0]) < 1e-9
    assert values[1] == pytest.approx(12.0 * (1 / 1.0 + 1 / 3.0), rel=1e-9)


def test_repeated_roots_give_orthogonal_shapes() -> None:
    values, shapes = lowest_modes(np.eye(4), np.diag([5.0, 5.0, 7.0, 5.0]), 3)
    np.testing.assert_allclose(values, 5.0, rtol=1e-12)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(3), atol=1e-12)


def test_a_coordinate_that_nothing_holds_is_an_error() -> None:
    mass, stiffness = chain([0.0, 0.0, 1.0], [1.0, 1.0], grounded=False)
    mass[2, 2] = 0.0
    with pytest.raises(PrsError, match="neither stiffness nor mass"):
        lowest_modes(mass, stiffness, 1)


def test_a_free_mass_beside_a_held_one_is_a_rigid_body_mode() -> None:
    values, _ = lowest_modes(np.eye(2), np.diag([1e6, 0.0]), 2)
    np.testing.assert_allclose(values, [0.0, 1e6], rtol=1e-12, atol=1e-6)


def test_an_indefinite_stiffness_is_named() -> None:
    with pytest.raises(PrsError, match="indefinite"):
        lowest_modes(np.eye(2), np.array([[1.0, 2.0], [2.0, 1.0]]), 1)
