"""A machine of finite elements: limbs alike with modes of equal frequency, coordinates from 48 Hz to 14 kHz."""

import numpy as np
import pytest

import prs_model as prs
from prs_model.synthesis import System
from tests.response.test_frf import difference


@pytest.fixture(scope="module")
def system() -> System:
    return prs.load_machine("head_3prs").assemble()


def test_all_modes_are_the_direct_solution(system: System) -> None:
    modes = system.modes(system.size)
    frequencies = np.concatenate([np.geomspace(5.0, 1000.0, 30), modes.frequencies[:8]])
    assert difference(modes.frf(frequencies, 0.025), system.frf(frequencies, 0.025)) < 1e-10


def test_eight_modes_with_static_correction(system: System) -> None:
    """Within 1 % up to the last kept mode; the modes alone are far off even at rest."""
    modes = system.modes(8)
    frequencies = np.linspace(5.0, modes.frequencies[-1], 60)
    exact = system.frf(frequencies, 0.025)
    assert difference(modes.frf(frequencies, 0.025), exact) < 0.01
    assert difference(modes.frf(frequencies[:1], 0.025, static_correction=False), exact[:1]) > 0.3


@pytest.mark.parametrize("quantity", ["receptance", "accelerance"])
def test_a_state_space_model_with_residual_vectors(system: System, quantity: str) -> None:
    """To 250 Hz with the modes to 1.5 times that; the modes alone are half off where the response is small."""
    modes = system.modes(14)
    assert modes.frequencies[-1] < 1.5 * 250.0
    frequencies = np.linspace(10.0, 250.0, 60)
    exact = system.frf(frequencies, 0.02, quantity=quantity)[:, :3, :3]
    for vectors, least, most in ((True, 0.0, 1e-4), (False, 0.02, 1.0)):
        model = modes.state_space(0.02, quantity=quantity, residual_vectors=vectors)
        found = model.frf(frequencies)[:, :3, :3]
        errors = np.abs(found - exact).max(axis=(1, 2)) / np.abs(exact).max(axis=(1, 2))
        assert least <= errors.max() < most


@pytest.mark.parametrize("each", [{"loss_factor": 0.1}, {"viscous": 1e-4}], ids=["loss", "viscous"])
def test_eight_modes_where_all_joints_damp(system: System, each: dict[str, float]) -> None:
    """What dampers do to the modes left out is not small; all modes are the check."""
    damping = {"joints": {system.stems[spring.joint]: each for spring in system.springs}}
    modes = system.modes(8)
    frequencies = np.linspace(5.0, modes.frequencies[-1], 60)
    exact = system.modes(system.size).frf(frequencies, damping)
    assert difference(modes.frf(frequencies, damping), exact) < 1e-8
    assert difference(modes.frf(frequencies, damping, static_correction=False), exact) > 0.05


def test_an_impulse_simulated_by_python_control_has_the_frf_as_its_spectrum(system: System) -> None:
    control = pytest.importorskip("control")
    modes = system.modes(8)
    model = modes.state_space(0.025, static_correction=False).to_control()
    times = np.arange(0.0, 1.5, 1e-4)
    impulse = control.impulse_response(model[0, 0], times).outputs
    for frequency in (30.0, 48.0, 206.0):
        spectrum = np.trapezoid(impulse * np.exp(-2j * np.pi * frequency * times), times)
        expected = modes.frf([frequency], 0.025, static_correction=False)[0, 0, 0]
        assert spectrum == pytest.approx(expected, rel=3e-3)
