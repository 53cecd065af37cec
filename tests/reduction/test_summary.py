"""The figures a designer knows by heart, and when they are called surprising."""

import logging
from dataclasses import replace
from math import pi

import numpy as np
import pytest

import prs_model as prs
from prs_model.readable import figure
from prs_model.reduction.summary import echo, summarize
from tests.meshes import STEEL, box, write

CUBE = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
INERTIA = {"xx": 0.1, "yy": 0.1, "zz": 0.1}


def pair(frequency: float, length: float = 1.0, mass: float = 2.0) -> prs.SuperElement:
    """Two equal masses on an axial spring: omega^2 = 2 k / m."""
    nodes = {"a": (0.0, 0.0, 0.0), "b": (length, 0.0, 0.0)}
    spring = {"between": ("a", "b"), "axial": (2.0 * pi * frequency) ** 2 * mass / 2.0}
    return prs.reduce(
        "lumped", options={"nodes": nodes, "masses": {name: {"mass": mass} for name in nodes}, "springs": [spring]}
    )


def ball(mass: float) -> prs.SuperElement:
    return prs.reduce("rigid", options={"mass": mass, "inertia": INERTIA, "nodes": {"a": (0.0, 0.0, 0.0)}})


def surprises(element: prs.SuperElement, points: np.ndarray | None = None) -> str:
    return "; ".join(summarize(element, points=points).surprises)


def test_what_no_part_has_is_surprising_and_nothing_else():
    """Osmium has 22.6 t/m^3; sound runs through diamond at 18 km/s."""
    assert surprises(ball(2.2e4), CUBE) == ""
    assert "denser than any metal; check the units of its numbers" in surprises(ball(2.4e4), CUBE)
    assert surprises(pair(0.9e4)) == ""
    assert "first frequency, free, 11000 Hz, is too high for a part 1 m long" in surprises(pair(1.1e4))
    assert surprises(pair(100.0, length=29.0)) == ""
    assert "its nodes are 31 m apart" in surprises(pair(100.0, length=31.0))
    assert "its nodes are 0.0009 m apart" in surprises(pair(100.0, length=9e-4))
    assert surprises(ball(0.9e6)) == ""
    assert "it weighs 1.1e+09 kg" in surprises(ball(1.1e9))


def test_a_structure_whose_file_is_always_in_si_may_be_large():
    jacket = replace(pair(3.0, length=70.0, mass=1e6), provenance={"reducer": "openfast"})
    assert surprises(jacket) == ""
    assert "check 'units'" in surprises(replace(jacket, provenance={}))


def test_a_held_part_is_not_called_free():
    spring = {"between": ("ground", "a"), "axial": (2.0 * pi * 0.159) ** 2, "along": (1, 0, 0)}
    stiff = {"between": ("ground", "a"), "stiffness": dict.fromkeys(("uy", "uz"), 1e12)}
    options = {"nodes": {"a": (0.0, 0.0, 0.0)}, "masses": {"a": {"mass": 1.0}}, "springs": [spring, stiff]}
    held = prs.reduce("lumped", grounded=True, options=options)
    assert summarize(held).free[0] == pytest.approx(0.159)
    assert summarize(held).properties is None
    assert "first frequency, held" in surprises(replace(held, stiffness=1e12 * held.stiffness), CUBE)


def test_a_part_that_has_no_frequency_is_shown_without(caplog):
    """A point mass meets nothing when it turns; a bar with one interface and no modes moves rigidly only."""
    point = prs.reduce("rigid", mass=2.5, nodes={"a": (0.0, 0.0, 0.0)})
    caplog.clear()
    with caplog.at_level(logging.INFO, logger="prs_model"):
        echo(point, "point")
    assert caplog.messages == ["point: 2.5 kg, nodes in 0 x 0 x 0 m"]
    bar = {"kind": "round", "diameter": 0.1, "material": STEEL}
    nodes = {"root": (0.0, 0.0, 0.0), "tip": (1.0, 0.0, 0.0)}
    members = [{"between": ("root", "tip"), "section": "bar"}]
    options = {"nodes": nodes, "sections": {"bar": bar}, "members": members}
    element = prs.reduce("beam", interfaces={"root": {"node": "root"}}, modes=0, options=options)
    assert summarize(element).free.size == 0


def test_the_size_is_that_of_the_whole_part(tmp_path, caplog):
    mesh = write(box((0.4, 0.1, 0.08), (3, 1, 1)), tmp_path / "block.msh", scale=1000.0)
    with caplog.at_level(logging.INFO, logger="prs_model"):
        element = prs.reduce("solid", mesh, interfaces={"root": {"set": "x0"}}, units="mm-N-tonne-s", material=STEEL)
    assert "block: 25.12 kg, in 0.4 x 0.1 x 0.08 m, first free frequency" in caplog.text
    assert "Hz with its interfaces tied" in caplog.text
    for bare in (element, replace(element, surface=None)):
        assert summarize(bare).whole
        assert summarize(bare).size == pytest.approx([0.4, 0.1, 0.08])
    nodes_only = summarize(replace(element, surface=None, provenance={}))
    assert (nodes_only.whole, *nodes_only.size) == (False, 0.0, 0.0, 0.0)
    assert nodes_only.as_dict()["size_of"] == "nodes"


@pytest.mark.parametrize(
    ("value", "text"), [(11634.0, "11634"), (0.35, "0.35"), (8.9e8, "890000000"), (5e9, "5e+09"), (1e-5, "1e-05")]
)
def test_figures_are_written_as_people_write_them(value, text):
    assert figure(value) == text
