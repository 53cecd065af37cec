"""The complete order where a contact travels along a part."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from tests.complete_order.monolithic import monolithic_frequencies
from tests.verification.gantry import gantry

RAIL = {
    "members": [
        {"name": "near", "set": "z1", "box": {"x": [0.01, 0.12]}},
        {"name": "far", "set": "z1", "box": {"x": [0.15, 0.26]}},
    ],
    "travel": {"joint": "slide_x", "along": [1, 0, 0], "stations": [-0.2, -0.1, 0.1, 0.2]},
}
REFERENCE = 0.375


@pytest.fixture
def machine(tmp_path: Path) -> prs.Machine:
    return gantry(tmp_path).replace({"bodies.column.interfaces.rail": RAIL})


@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
def test_off_its_stations_it_equals_the_monolithic_matrix(machine, coupling):
    complete = machine.complete_order(coupling)
    for stroke in (-0.013, 0.047):
        configuration = machine.configuration(x=REFERENCE + stroke, phi=0.4)
        modes = complete.modes(configuration, 8)
        expected = monolithic_frequencies(complete.joined(configuration), 8)
        assert modes.frequencies == pytest.approx(expected, rel=1e-8)


def test_averaged_contacts_move_smoothly_over_the_mesh(machine):
    complete = machine.complete_order()
    strokes = np.linspace(-0.03, 0.06, 19)
    frequencies = np.array(
        [complete.modes(machine.configuration(x=REFERENCE + stroke), 6).frequencies for stroke in strokes]
    )
    x = strokes / np.max(np.abs(strokes))
    smooth = np.polynomial.polynomial.polyval(x, np.polynomial.polynomial.polyfit(x, frequencies, 4)).T
    assert np.abs(frequencies / smooth - 1.0).max() < 1e-4
