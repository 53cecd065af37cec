"""A joint-loaded part whose contact travels: the gantry's table on a long column."""

import numpy as np
import pytest

import prs_model as prs
from tests.meshes import box, write
from tests.verification.gantry import gantry

RAIL = {
    "at": [0.375, 0.05, 0.3],
    "members": [
        {"name": "near", "set": "z1", "box": {"x": [0.24, 0.36]}},
        {"name": "far", "set": "z1", "box": {"x": [0.39, 0.51]}},
    ],
    "travel": {"joint": "slide_x", "along": [1, 0, 0], "stations": [-0.2, -0.1, 0.0, 0.1, 0.2]},
}
MIDDLE = 0.625  # pose x [m] with the slide at zero


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gantry")
    gantry(folder)
    write(box((0.8, 0.1, 0.3), (10, 1, 2)), folder / "column.msh")
    for name, changes in {
        "gantry.urdf": {'xyz="0 0 0.3"': 'xyz="0.25 0 0.3"'},
        "machine.yaml": {"x: [0.275, 0.475]": "x: [0.525, 0.725]", "{x: 0.375,": "{x: 0.625,"},
    }.items():
        text = (folder / name).read_text()
        for old, new in changes.items():
            assert old in text
            text = text.replace(old, new)
        (folder / name).write_text(text)
    loaded = {"reduction": {"method": "joint-loaded", "modes": 3}, "bodies.column.interfaces.rail": RAIL}
    return prs.load_machine(folder).replace(loaded)


def test_between_stations_it_stays_near_the_complete_order(machine):
    order = machine.complete_order("averaged")
    for slide in (-0.2, -0.1, -0.14, 0.03, 0.15):
        exact = order.modes(machine.configuration(x=MIDDLE + slide), 8).frequencies
        error = machine.modes(8, x=MIDDLE + slide).frequencies / exact - 1.0
        assert np.abs(error).max() < 0.01
        if slide in RAIL["travel"]["stations"]:
            assert error.min() > -1e-8


def test_frequencies_are_smooth_in_the_stroke(machine):
    slides = np.linspace(-0.15, 0.0, 61)
    frequencies = np.array([machine.modes(8, x=MIDDLE + slide).frequencies for slide in slides])
    steps = np.diff(frequencies, axis=0) / frequencies[1:]
    assert np.abs(np.diff(steps, axis=0)).max() < 0.1 * np.abs(steps).max()


def test_a_joint_too_soft_to_reckon_with_is_told() -> None:
    """Ten million times softer than described, the drive leaves round-off of the board's own flexibility."""
    soft = prs.load_machine("head_3prs").replace({"joints.P.stiffness_factor": 1e-7})
    with pytest.raises(prs.PrsError, match="board, whose contact travels with joint slide_1: found a flexibility"):
        soft.modes(6)
