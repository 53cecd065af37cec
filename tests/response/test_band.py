"""The frequencies at which a response is asked for."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.response.band import band
from prs_model.response.damping import damping_of
from prs_model.response.modal_equations import damping_ratios
from tests.response.two_masses import row


@pytest.mark.parametrize("damping", [5e-4, 0.02, {"joints": {"P": {"loss_factor": 0.02}}}])
def test_no_peak_falls_between_the_lines(damping: object) -> None:
    modes = prs.load_machine("hexapod").modes(6)
    ratios = damping_ratios(modes, damping_of(modes.system, damping))
    lines = band(modes, ratios)
    assert (lines[0], lines[-1]) == pytest.approx((0.1 * modes.frequencies[0], 1.25 * modes.frequencies[-1]), rel=1e-5)
    assert np.all(np.diff(lines) > 0.0)
    found = np.abs(modes.frf(lines, damping))
    for frequency, ratio in zip(modes.frequencies, ratios, strict=True):
        near = frequency * (1.0 + ratio * np.linspace(-3.0, 3.0, 301))
        exact = np.abs(modes.frf(near, damping))
        of_mode = np.abs(lines - frequency) < 3.0 * ratio * frequency
        for axis in range(3):
            assert found[of_mode, axis, axis].max() > 0.99 * exact[:, axis, axis].max()


def test_modes_without_damping_are_not_met() -> None:
    modes = prs.load_machine("hexapod").modes(6)
    lines = band(modes, np.zeros(6))
    assert np.isin(modes.frequencies, lines).sum() == 0
    assert np.abs(lines - modes.frequencies[0]).min() < 1e-4 * modes.frequencies[0]
    assert np.isfinite(modes.frf(lines, 0.0)).all()


def test_rigid_motions_have_no_peak(tmp_path: Path) -> None:
    modes = row(tmp_path, ground=False).modes(7)
    lines = band(modes, damping_ratios(modes, damping_of(modes.system, 0.02)))
    assert lines[0] == pytest.approx(0.1 * modes.frequencies[3], rel=1e-5)
    assert band(prs.Modes(modes.system, modes.eigenvalues[:3], modes.shapes[:, :3]), np.full(3, np.nan)).size == 0


def test_ratios_are_those_of_complex_modes(tmp_path: Path) -> None:
    """To first order, so to a per cent of ratios near a per cent."""
    system = row(tmp_path).assemble()
    damping = {"modal": 0.01, "joints": {"wall": {"viscous": 1e-4}, "spring": {"loss_factor": 0.01}}}
    found = damping_ratios(system.modes(2), damping_of(system, damping))
    assert found == pytest.approx(system.complex_modes(2, damping).damping_ratios, rel=1e-2)
