"""Complex modes: a known answer, and the limits in which they become real ones."""

from pathlib import Path

import numpy as np
import pytest

from tests.response.two_masses import K1, K2, M1, M2, row
from tests.verification.gantry import gantry


def test_two_masses_with_dampers(tmp_path: Path) -> None:
    """Roots of (m1 s^2 + c1 s + k1 + c2 s + k2)(m2 s^2 + c2 s + k2) - (c2 s + k2)^2, and the shapes they give."""
    c1, c2 = 3.0e-4 * K1, 4.0e-3 * K2
    system = row(tmp_path).assemble()
    modes = system.complex_modes(2, {"joints": {"wall": {"viscous": c1 / K1}, "spring": {"viscous": c2 / K2}}})
    lower = np.poly1d([c2, K2])
    roots = (np.poly1d([M1, c1 + c2, K1 + K2]) * np.poly1d([M2, c2, K2]) - lower * lower).roots
    expected = np.sort_complex(roots[roots.imag > 0.0])
    expected = expected[np.argsort(np.abs(expected))]
    assert modes.poles == pytest.approx(expected, rel=1e-10)
    assert modes.frequencies == pytest.approx(np.abs(expected) / (2.0 * np.pi))
    assert modes.damping_ratios == pytest.approx(-expected.real / np.abs(expected))
    one, two = _places(system)
    ratio = (M2 * expected**2 + c2 * expected + K2) / (c2 * expected + K2)  # of mass 1 over mass 2
    assert (one @ modes.shapes) / (two @ modes.shapes) == pytest.approx(ratio, rel=1e-9)
    assert np.all(modes.collinearity < 0.999)


def test_two_masses_with_a_loss_factor(tmp_path: Path) -> None:
    """With one loss factor everywhere s^2 = -omega^2 (1 + j eta), and the shapes stay real."""
    system = row(tmp_path).assemble()
    real = system.modes(2)
    modes = system.complex_modes(2, {"joints": {"wall": {"loss_factor": 0.06}, "spring": {"loss_factor": 0.06}}})
    assert modes.poles**2 == pytest.approx(-real.eigenvalues * (1.0 + 0.06j), rel=1e-10)
    assert modes.damping_ratios == pytest.approx([0.03, 0.03], rel=1e-2)
    assert modes.collinearity == pytest.approx([1.0, 1.0])


def test_without_damping_they_are_the_real_modes(tmp_path: Path) -> None:
    system = gantry(tmp_path).assemble()
    real = system.modes(8)
    assert "-0" not in repr(system.complex_modes(8, 0.0))
    for damping, distance in ((0.0, 1e-9), ({"joints": {"X": {"viscous": 1e-10}, "Y": {"loss_factor": 1e-7}}}, 1e-5)):
        modes = system.complex_modes(8, damping)
        assert modes.frequencies == pytest.approx(real.frequencies, rel=1e-8)
        assert modes.damping_ratios == pytest.approx(np.zeros(8), abs=1e-6)
        overlap = np.abs(modes.shapes.conj().T @ system.mass @ real.shapes)
        assert overlap == pytest.approx(np.eye(8), abs=distance)


def test_proportional_damping_keeps_shapes_and_undamped_frequencies(tmp_path: Path) -> None:
    system = row(tmp_path).assemble()
    modes = system.complex_modes(2, [0.1, 0.4])
    assert modes.frequencies == pytest.approx(system.modes(2).frequencies)
    assert modes.damping_ratios == pytest.approx([0.1, 0.4])
    assert modes.shapes.imag == pytest.approx(np.zeros_like(modes.shapes.imag), abs=1e-9)


def test_what_does_not_oscillate_is_left_out(tmp_path: Path) -> None:
    """An overdamped mode, and the six rigid motions of a free machine."""
    system = row(tmp_path).assemble()
    assert len(system.complex_modes(2, {"joints": {"spring": {"viscous": 1.0}}}).poles) == 1
    free = row(tmp_path, ground=False).assemble()
    assert free.complex_modes(7, 0.02).frequencies == pytest.approx(free.modes(7).frequencies[-1:])


def _places(system) -> tuple[np.ndarray, np.ndarray]:
    """Rows that read the motion along x of each mass."""
    return tuple(
        (system.elements[body].motions[0] @ system.expansion[system.blocks[body]])[0] for body in ("one", "two")
    )
