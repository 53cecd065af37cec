"""State-space models and responses in time, against closed forms, SciPy and python-control."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

import prs_model as prs
from tests.response.two_masses import K1, K2, row
from tests.verification.gantry import gantry

JOINTS = {"modal": 0.03, "joints": {"spring": {"viscous": 2e-3}}}


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_its_transfer_function_is_the_frf(tmp_path: Path, quantity: str) -> None:
    modes = gantry(tmp_path).modes(10)
    frequencies = np.array([5.0, 80.0, 300.0])
    damping = {"modal": 0.02, "joints": {"X": {"viscous": 1e-5}}}
    model = modes.state_space(damping, to="table.end", quantity=quantity)
    found = model.frf(frequencies)
    expected = modes.frf(frequencies, damping, "table.end", None, quantity, static_correction=False)
    if quantity == "receptance":  # what the modes left out do at rest
        expected = expected + (
            modes.static_compliance("table.end") - modes.frf([1e-4], 0.0, "table.end", static_correction=False)[0].real
        )
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_an_impulse_simulated_by_python_control_has_the_frf_as_its_spectrum(tmp_path: Path) -> None:
    control = pytest.importorskip("control")
    system = row(tmp_path).assemble()
    model = system.state_space(2, JOINTS).to_control()
    assert (model.input_labels[0], model.output_labels[5]) == ("f_u", "x_rw")
    times = np.arange(0.0, 4.0, 2e-4)
    impulse = control.impulse_response(model[0, 0], times).outputs
    for frequency in (5.0, 11.0, 23.0):
        spectrum = np.trapezoid(impulse * np.exp(-2j * np.pi * frequency * times), times)
        assert spectrum == pytest.approx(system.frf([frequency], JOINTS)[0, 0, 0], rel=1e-4)


def test_a_force_that_is_switched_on(tmp_path: Path) -> None:
    """One damped mode in closed form: f / k (1 - e^(-xi w t) (cos w_d t + xi w / w_d sin w_d t)); then it rests."""
    modes = prs.load_machine("hexapod").modes(3)
    single = prs.Modes(modes.system, modes.eigenvalues[2:], modes.shapes[:, 2:])  # along w
    step, ratio = 1e-4, 0.05
    times = step * np.arange(400)
    force = np.tile([0.0, 0.0, 10.0], (400, 1))
    found = single.state_space(ratio, static_correction=False).response(force, step, hold="constant")[:, 2]
    w = np.sqrt(single.eigenvalues[0])
    damped = w * np.sqrt(1.0 - ratio**2)
    swing = np.exp(-ratio * w * times) * (np.cos(damped * times) + ratio * w / damped * np.sin(damped * times))
    assert found == pytest.approx(10.0 * single.modal_flexibility()[0, 2] * (1.0 - swing), rel=1e-9, abs=1e-18)


@pytest.mark.parametrize("hold", ["linear", "constant"])
def test_any_force_as_scipy_simulates_it(tmp_path: Path, hold: str) -> None:
    model = gantry(tmp_path).assemble().state_space(6, 0.02)
    step, forces = 5e-5, np.random.default_rng(1).normal(size=(200, 6))
    found = model.response(forces, step, hold)
    _, expected, _ = lsim(model.to_scipy(), forces, step * np.arange(200), interp=hold == "linear")
    expected = expected.reshape(200, 6)
    assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_a_steady_force_ends_in_the_static_displacement(tmp_path: Path) -> None:
    model = row(tmp_path).modes(1).state_space(0.2)
    forces = np.zeros((4000, 6))
    forces[:, 0] = 5.0
    assert model.response(forces, 1e-3)[-1, 0] == pytest.approx(5.0 * (1.0 / K1 + 1.0 / K2), rel=1e-9)


def test_a_correction_that_would_do_nothing_is_refused(tmp_path: Path) -> None:
    modes = row(tmp_path).modes(1)
    for given in ({"quantity": "mobility"}, {"quantity": "accelerance"}, {"residual_vectors": True}):
        with pytest.raises(prs.PrsError, match="in a receptance only; take residual_vectors"):
            modes.state_space(0.02, static_correction=True, **given)


def test_a_loss_factor_has_no_model_in_time(tmp_path: Path) -> None:
    modes = row(tmp_path, "joints: {spring: {loss_factor: 0.03}}").modes(2)
    with pytest.raises(prs.PrsError, match="no model in time; give the joint a viscous time constant"):
        modes.state_space()


@pytest.mark.parametrize(
    ("forces", "step", "hold", "words"),
    [
        (np.zeros((5, 2)), 1e-3, "linear", r"found an array of shape \(5, 2\)"),
        (np.zeros(5), 1e-3, "linear", r"found an array of shape \(5,\)"),
        ([["a", "b", "c"]], 1e-3, "linear", "forces: found"),
        (np.full((5, 3), np.nan), 1e-3, "linear", "forces: found nan"),
        (np.full((5, 3), 1j), 1e-3, "linear", "forces: found array"),
        (np.zeros((5, 3)), 0.0, "linear", "step: found 0.0"),
        (np.zeros((5, 3)), None, "linear", "step: found None, expected a time between samples above zero"),
        (np.zeros((5, 3)), "a", "linear", "step: found 'a'"),
        (np.zeros((5, 3)), 1e300, "linear", "found 1e[+]300 s, too long for a system this fast"),
        (np.zeros((5, 3)), 1e-3, "cubic", "unknown hold 'cubic'; known: linear, constant"),
    ],
)
def test_wrong_samples_are_told(tmp_path: Path, forces: object, step: float, hold: str, words: str) -> None:
    model = row(tmp_path).modes(2).state_space()
    with pytest.raises(prs.PrsError, match=words):
        model.response(forces, step, hold)
