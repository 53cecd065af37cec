"""Interpolation on boxes: exact where it should be, and honest about the rest."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model.sweep.interpolated.spectral import Axis, Box, on_grid

TURN = 2.0 * np.pi
X = Axis("chebyshev", -0.3, 1.1, 7)
PSI = Axis("fourier", 0.4, 0.4 + TURN, 9)


def polynomial(points: np.ndarray) -> np.ndarray:
    """Of degree 6 in x and 4 in psi: what 7 and 9 nodes resolve, two columns."""
    x, psi = points.T
    return np.column_stack([x**6 - 2.0 * x * np.cos(4.0 * psi), 1.0 + x**3 * np.sin(3.0 * psi)])


def smooth(points: np.ndarray) -> np.ndarray:
    """Analytic, with poles beside the box."""
    x, psi = points.T
    return np.column_stack([1.0 / (1.8 - x), np.exp(0.5 * np.cos(psi)) / (1.2 + x**2 + 0.3 * np.sin(psi))])


def some(axes: tuple[Axis, ...], count: int = 300) -> np.ndarray:
    low, high = np.array([(axis.low, axis.high) for axis in axes]).T
    return low + (high - low) * np.random.default_rng(5).random((count, len(axes)))


def tensor_of(box: Box, function: object) -> np.ndarray:
    return box.unfold(function(box.poses()[:, list(box.columns)]))


def plain(axes: tuple[Axis, ...]) -> Box:
    return Box(axes, tuple(range(len(axes))), np.zeros(len(axes)))


def test_polynomials_and_trigonometric_polynomials_are_exact() -> None:
    box = plain((X, PSI))
    tensor, points = tensor_of(box, polynomial), some(box.axes)
    np.testing.assert_allclose(box.terms(tensor, 0.0).at(points), polynomial(points), atol=1e-13)
    weights = [axis.weights(np.unique(points[:40, k])) for k, axis in enumerate(box.axes)]
    mesh = np.meshgrid(*(np.unique(points[:40, k]) for k in range(2)), indexing="ij")
    found = on_grid(np.moveaxis(tensor, -1, 0), weights)
    expected = polynomial(np.column_stack([each.ravel() for each in mesh])).T.reshape(2, 40, 40)
    np.testing.assert_allclose(found, expected, atol=1e-13)


@pytest.mark.parametrize(
    "axis", [X, PSI, Axis("fourier", 0.0, TURN, 8), Axis("given", 0.0, 2.0, 2, np.array([0.0, 2.0]))]
)
def test_values_at_the_nodes_are_kept(axis: Axis) -> None:
    np.testing.assert_allclose(axis.weights(axis.nodes), np.eye(axis.count), atol=1e-13)
    assert np.abs(axis.terms(some((axis,))[:, 0])).max() <= 1.0


def test_half_of_a_mirrored_box_says_as_much_as_the_whole() -> None:
    """A function of the tilt's components theta cos psi, theta sin psi is that of a point, also for theta < 0."""

    def of_tilt(points: np.ndarray) -> np.ndarray:
        u, v = points[:, 1] * np.cos(points[:, 0]), points[:, 1] * np.sin(points[:, 0])
        return np.column_stack([np.exp(u - 0.3 * v), 1.0 / (2.0 + u * v)])

    axes = (Axis("fourier", 0.0, TURN, 12), Axis("chebyshev", -0.5, 0.5, 8))
    fixed = np.array([0.0, 1.275, 0.0])
    whole, half = Box(axes, (0, 2), fixed), Box(axes, (0, 2), fixed, mirror=(1, 0))
    assert len(half.poses()) == len(whole.poses()) / 2
    assert half.poses()[:, 2].min() > 0.0
    assert (half.poses()[:, 1] == 1.275).all()
    np.testing.assert_allclose(tensor_of(half, of_tilt), tensor_of(whole, of_tilt), atol=1e-14)


def of_three_limbs(points: np.ndarray) -> np.ndarray:
    return 1.0 / (1.3 + np.cos(3.0 * points[:, :1]))


@pytest.mark.parametrize("counts", [(7, 9), (12, 14), (20, 15), (20, 24)])
def test_the_tail_bounds_the_error(counts: tuple[int, int]) -> None:
    box = plain((Axis("chebyshev", -0.3, 1.1, counts[0]), Axis("fourier", 0.4, 0.4 + TURN, counts[1])))
    tensor, points = tensor_of(box, smooth), some(box.axes, 2000)
    worst = np.linalg.norm(box.terms(tensor, 0.0).at(points) - smooth(points), axis=1).max()
    assert 3e-4 * sum(box.tail(tensor)) < worst < sum(box.tail(tensor))


@pytest.mark.parametrize("count", [15, 21, 27, 33, 45])
def test_the_tail_sees_a_function_of_every_third_order(count: int) -> None:
    """As machines of three like limbs make when they are turned."""
    box = plain((Axis("fourier", 0.0, TURN, count),))
    tensor, points = tensor_of(box, of_three_limbs), some(box.axes, 999)
    worst = np.abs(box.terms(tensor, 0.0).at(points) - of_three_limbs(points)).max()
    assert box.tail(tensor)[0] > 0.5 * worst


def test_the_tail_tells_the_axis_along_which_nodes_are_missing() -> None:
    box = plain((Axis("chebyshev", -0.3, 1.1, 6), Axis("fourier", 0.4, 0.4 + TURN, 30)))
    along_x, along_psi = box.tail(tensor_of(box, smooth))
    assert along_psi < 1e-6 * along_x


@pytest.mark.parametrize("negligible", [1e-3, 1e-6, 1e-9])
def test_terms_left_out_are_negligible_and_many(negligible: float) -> None:
    box = plain((Axis("chebyshev", -0.3, 1.1, 24), Axis("fourier", 0.4, 0.4 + TURN, 24)))
    tensor, points = tensor_of(box, smooth), some(box.axes, 500)
    short, full = box.terms(tensor, negligible), box.terms(tensor, 0.0)
    assert len(short.factors) < len(full.factors)
    assert np.linalg.norm(short.at(points) - full.at(points), axis=1).max() <= negligible


def test_given_values_are_taken_as_they_are() -> None:
    """Nothing is smooth along them, and nothing is said of what lies between them."""
    given = np.array([0.0, 0.1, 5.0])
    box = plain((Axis("given", 0.0, 5.0, 3, given), Axis("chebyshev", -1.0, 1.0, 5)))
    rough = {0.0: 1.0, 0.1: -7.0, 5.0: 1e3}

    def function(points: np.ndarray) -> np.ndarray:
        return np.array([[rough[x] * y**4] for x, y in points])

    tensor = tensor_of(box, function)
    points = np.column_stack([np.repeat(given, 4), np.tile([-1.0, -0.2, 0.4, 1.0], 3)])
    np.testing.assert_allclose(box.terms(tensor, 0.0).at(points), function(points), rtol=1e-12, atol=1e-12)
    assert box.tail(tensor)[0] == 0.0
    assert box.tail(tensor)[1] > 1.0
