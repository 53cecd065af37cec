"""How many nodes are asked for is enough, and hardly more than that."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model.sweep.interpolated.convergence import Need, need
from prs_model.sweep.interpolated.spectral import Axis


def on_line(axis: Axis) -> np.ndarray:
    """1 / (1.3 - x) and a harmless polynomial (1, n, 2): terms fall by about 0.47 each."""
    return np.column_stack([1.0 / (1.3 - axis.nodes), axis.nodes**2])[None]


def error(count: int) -> float:
    axis, at = Axis("chebyshev", -1.0, 1.0, count), np.linspace(-1.0, 1.0, 400)
    return float(np.abs(axis.weights(at) @ on_line(axis)[0, :, 0] - 1.0 / (1.3 - at)).max())


@pytest.mark.parametrize("most", [1e-2, 1e-3, 3e-5, 1e-6])
def test_nodes_are_enough_and_hardly_more(most: float) -> None:
    axis = Axis("chebyshev", -1.0, 1.0, 17)
    found = need(axis, on_line(axis), most, 1.5)
    assert found is not None
    assert error(found.count) < most
    assert error(found.count - 5) > most
    assert found.fall == pytest.approx(0.47, abs=0.05)


def test_what_is_too_far_beyond_the_line_is_not_reckoned() -> None:
    axis = Axis("chebyshev", -1.0, 1.0, 17)
    assert need(axis, on_line(axis), 1e-9, 1.5) is None
    assert need(axis, on_line(axis), 1e-6, 1.0) is None


def test_an_order_in_three_is_not_taken_for_convergence() -> None:
    axis = Axis("fourier", 0.0, 2.0 * np.pi, 17)
    line = (1.0 / (1.2 - np.cos(3.0 * axis.nodes)))[None, :, None]
    assert need(axis, line, 1e-3, 1.5) is None


def test_further_nodes_bring_an_error_down() -> None:
    assert Need(10, 0.5).more(10, 8.0) == 13
    assert Need(10, 0.5).more(10, 1.01) == 11
