"""Rigid constraints are eliminated exactly, redundant ones too, and physical coordinates are kept."""

import numpy as np

from prs_model.synthesis.elimination import independent_coordinates


def test_expansion_spans_the_null_space() -> None:
    generator = np.random.default_rng(2)
    constraints = generator.normal(size=(4, 10))
    redundant = np.vstack([constraints, generator.normal(size=(3, 4)) @ constraints])
    expansion, kept = independent_coordinates(redundant, np.ones(7))
    assert expansion.shape == (10, 6)
    np.testing.assert_allclose(redundant @ expansion, 0.0, atol=1e-12)
    np.testing.assert_array_equal(expansion[kept], np.eye(6))


def test_round_off_constrains_nothing() -> None:
    constraints = np.vstack([np.eye(2, 4), 1e-15 * np.ones((1, 4))])
    expansion, kept = independent_coordinates(constraints, np.ones(3))
    np.testing.assert_array_equal(kept, [2, 3])
    np.testing.assert_array_equal(expansion, np.eye(4)[:, 2:])


def test_without_constraints_all_coordinates_stay() -> None:
    expansion, kept = independent_coordinates(np.zeros((0, 5)), np.zeros(0))
    np.testing.assert_array_equal(expansion, np.eye(5))
    np.testing.assert_array_equal(kept, np.arange(5))
