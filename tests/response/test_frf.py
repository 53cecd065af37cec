"""Frequency responses: closed forms, modal against direct, truncation, reciprocity, units."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.synthesis import System
from tests.response.two_masses import K1, K2, M2, receptance, row
from tests.verification.gantry import gantry

JOINTS = {"modal": 0.01, "joints": {"X": {"loss_factor": 0.05}, "R": {"viscous": 2e-5}}}
RAYLEIGH = {"rayleigh": {"alpha": 5.0, "beta": 2e-5}}


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> System:
    machine = gantry(tmp_path_factory.mktemp("gantry"))
    return machine.assemble(machine.configuration(phi=0.3))


def difference(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference at any frequency, relative to the largest entry there; translations, then rotations."""
    blocks = [(slice(None), rows, columns) for rows in (slice(3), slice(3, 6)) for columns in (slice(3), slice(3, 6))]
    sizes = [np.abs(expected[block]).max(axis=(1, 2)) for block in blocks]
    errors = [np.abs(found[block] - expected[block]).max(axis=(1, 2)) for block in blocks]
    return max(float(np.max(error / size)) for error, size in zip(errors, sizes, strict=True))


def test_two_masses_answer_in_closed_form(tmp_path: Path) -> None:
    """Loss factor on one spring, a time constant on the other: k2 (1 + j eta), k1 (1 + j omega tau)."""
    system = row(tmp_path).assemble()
    damping = {"joints": {"spring": {"loss_factor": 0.04}, "wall": {"viscous": 1e-4}}}
    frequencies = np.linspace(1.0, 40.0, 60)
    for to, i in (("one.end", 0), (None, 1)):
        for at, j in (("one.end", 0), ("two.end", 1)):
            found = system.frf(frequencies, damping, to, at)[:, 0, 0]
            expected = [
                receptance(f, K1 * (1.0 + 2j * np.pi * f * 1e-4), K2 * (1.0 + 0.04j))[i, j] for f in frequencies
            ]
            assert found == pytest.approx(np.array(expected), rel=1e-10)


@pytest.mark.parametrize(
    "damping", [0.025, [0.01, 0.03, 0.02], RAYLEIGH, JOINTS], ids=["one", "each", "Rayleigh", "joints"]
)
def test_all_modes_are_the_direct_solution(system: System, damping: object) -> None:
    """Also of the peaks and between nodes of different bodies."""
    modes = system.modes(system.size)
    frequencies = np.concatenate([np.geomspace(5.0, 3000.0, 40), modes.frequencies[:12]])
    for to, at in ((None, None), ("table.end", None), ("saddle.top", "arm.foot")):
        found, expected = modes.frf(frequencies, damping, to, at), system.frf(frequencies, damping, to, at)
        assert difference(found, expected) < 1e-10


@pytest.mark.parametrize("damping", [0.025, RAYLEIGH, JOINTS], ids=["modal", "Rayleigh", "joints"])
def test_truncation_with_static_correction(tmp_path: Path, damping: object) -> None:
    """Within 1 % up to the last kept mode, at every frequency; without the correction far off even at rest."""
    system = gantry(tmp_path).replace({"reduction.modes": 15}).assemble()
    for count in (2, 8, 16):
        modes = system.modes(count)
        frequencies = np.linspace(5.0, modes.frequencies[-1], 200)
        exact = system.frf(frequencies, damping)
        assert difference(modes.frf(frequencies, damping), exact) < 0.01
        assert difference(modes.frf(frequencies[:1], damping, static_correction=False), exact[:1]) > 0.1


def test_at_rest_it_is_the_compliance_by_a_solve(system: System) -> None:
    """However few the modes, and it takes more than them: the modal sum alone lacks a part."""
    for modes in (system.modes(3), system.modes(system.size)):
        for to, at in ((None, None), ("table.end", None)):
            compliance = modes.static_compliance(to, at)
            rest = modes.frf([1e-4], 0.0, to, at)[0]
            assert rest.imag == pytest.approx(0.0)
            assert rest.real == pytest.approx(compliance, rel=1e-9, abs=1e-9 * np.abs(compliance).max())


@pytest.mark.parametrize("damping", [0.025, JOINTS], ids=["modal", "joints"])
def test_force_and_motion_may_change_places(system: System, damping: object) -> None:
    there = system.frf([30.0, 200.0], damping, "table.end", "arm.tip")
    back = system.frf([30.0, 200.0], damping, "arm.tip", "table.end")
    assert there == pytest.approx(back.transpose(0, 2, 1), rel=1e-9, abs=1e-12 * np.abs(there).max())


def test_velocity_and_acceleration(system: System) -> None:
    modes, frequencies = system.modes(6), np.array([20.0, 100.0])
    omega = 2.0 * np.pi * frequencies[:, None, None]
    receptance = modes.frf(frequencies)
    assert modes.frf(frequencies, quantity="mobility") == pytest.approx(1j * omega * receptance)
    assert modes.frf(frequencies, quantity="accelerance") == pytest.approx(-(omega**2) * receptance)


def test_labels_and_units(system: System) -> None:
    response = system.modes(4).frequency_response([20.0, 30.0, 40.0], to="table.end", quantity="mobility")
    table = response.to_xarray()
    assert table.sel(response="w", excitation="ru", frequency=30.0).item() == response.curve("w/ru")[1]
    assert table.unit.sel(response="w", excitation="ru").item() == response.unit("w/ru") == "m/s/(N m)"
    assert (table.attrs["to"], table.attrs["at"], table.frequency.attrs["units"]) == ("table.end", "output", "Hz")


def test_a_free_machine_answers_too(tmp_path: Path) -> None:
    """Far below its first frequency it moves as a whole: -1 / (m omega^2)."""
    system = row(tmp_path, ground=False).assemble()
    modes = system.modes(7)
    found = modes.frf([0.5], 0.01)[0, 0, 0]
    assert found == pytest.approx(-1.0 / (5.0 * np.pi**2), rel=1e-2)
    assert found == pytest.approx(system.frf([0.5], 0.01)[0, 0, 0], rel=1e-9)
    with pytest.raises(prs.PrsError, match="move without straining anything"):
        system.static_compliance()
    with pytest.raises(prs.PrsError, match="0 Hz"):
        modes.modal_flexibility()
    with pytest.raises(prs.PrsError, match="found 3 modes, all at 0 Hz, expected some above; ask for more modes"):
        system.modes(3).frf([0.5])


def test_far_beyond_the_modes_kept_is_a_guess(system: System, caplog: pytest.LogCaptureFixture) -> None:
    modes = system.modes(3)
    modes.frf([5.0, 1.2 * modes.frequencies[-1]])
    system.modes(system.size).frf([5.0, 1e5])
    assert not caplog.text
    modes.frf([5.0, 1.4 * modes.frequencies[-1]])
    assert "the last of 3 modes is at" in caplog.text


def test_motions_without_mass_follow_at_once(tmp_path: Path) -> None:
    """Mass 1 left out: two springs in a row carry mass 2, and their joint follows at once."""
    system = row(tmp_path).assemble()
    first = next(k for k, coordinate in enumerate(system.index) if coordinate.body == "one")
    mass = system.mass.copy()
    mass[first] = mass[:, first] = 0.0
    modes = replace(system, mass=mass).modes(2)
    assert len(modes.frequencies) == 1
    frequencies = np.array([3.0, 12.0, 50.0])
    swing = 1.0 / (1.0 / (1.0 / K1 + 1.0 / K2) - (2.0 * np.pi * frequencies) ** 2 * M2)
    assert modes.frf(frequencies, 0.0)[:, 0, 0].real == pytest.approx(swing)
    own = 1.0 / (K1 + K2) + (K2 / (K1 + K2)) ** 2 * swing
    assert modes.frf(frequencies, 0.0, "one.end", "one.end")[:, 0, 0].real == pytest.approx(own)


def test_without_damping_a_resonance_is_told(tmp_path: Path) -> None:
    modes = prs.load_machine("hexapod").modes(6)
    with pytest.raises(prs.PrsError, match="an undamped mode resonates"):
        modes.frf(modes.frequencies, 0.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"frequencies_hz": [0.0, 10.0]}, "found 0 Hz, expected a list of numbers above zero"),
        ({"frequencies_hz": -5.0}, "found -5 Hz"),
        ({"frequencies_hz": [float("nan")]}, "frequencies: found nan, expected a list of numbers above zero"),
        ({"frequencies_hz": [10.0, 1e160]}, r"found 1e\+160 Hz, expected a list of numbers .* to 1e\+09"),
        ({"frequencies_hz": [10.0 + 1.0j]}, r"found \[\(10\+1j\)\], expected a list of numbers"),
        ({"frequencies_hz": []}, r"found an array of shape \(0,\)"),
        ({"frequencies_hz": "fast"}, "found 'fast'"),
        ({"to": "one.and"}, "unknown node of one 'and'; known: end"),
        ({"to": "three.end"}, "unknown body 'three'; known: output, one, two"),
        ({"at": "one"}, "node: found 'one', expected body.node, one of one.end"),
        ({"quantity": "stiffness"}, "unknown quantity 'stiffness'; known: receptance, mobility, accelerance"),
    ],
)
@pytest.mark.parametrize("way", ["modal", "direct"])
def test_wrong_input_is_told(tmp_path: Path, way: str, arguments: dict[str, object], words: str) -> None:
    system = row(tmp_path).assemble()
    model = system if way == "direct" else system.modes(2)
    with pytest.raises(prs.PrsError, match=words):
        model.frf(**{"frequencies_hz": [10.0], **arguments})
