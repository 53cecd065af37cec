"""The rigid reducer: one body, six coordinates, exact mass properties."""

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.schema import Body, ReductionDefaults
from prs_model.description.units import Units
from prs_model.reduction import build_part
from prs_reducers.rigid import RigidOptions


def test_mass_properties_and_motions(tmp_path):
    inertia = {"xx": 2.0, "yy": 3.0, "zz": 4.0, "xy": 0.1, "xz": -0.2, "yz": 0.3}
    nodes = {"foot": (0.0, 0.0, -0.5), "head": (0.1, 0.2, 0.7)}
    body = prs.reduce("rigid", mass=5.0, centre=(0.1, -0.2, 0.3), inertia=inertia, nodes=nodes)
    found = body.mass_properties()
    assert found.mass == pytest.approx(5.0)
    assert found.centre == pytest.approx([0.1, -0.2, 0.3])
    assert found.inertia == pytest.approx(np.array([[2.0, 0.1, -0.2], [0.1, 3.0, 0.3], [-0.2, 0.3, 4.0]]))
    turn = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    head = body.motions[body.node("head")] @ turn
    assert head == pytest.approx([-0.4, 0.0, 0.0, 0.0, 0.0, 1.0])
    assert body.labels[0] == "centre.ux"


def test_options_are_in_the_units_of_the_machine(tmp_path):
    entries = {"mass": 500.0, "nodes": {"end": (0.0, 0.0, 25.0)}}
    units = Units(length="mm", mass="g")
    options = RigidOptions.model_validate(entries, context={"units": units}).model_dump(exclude_unset=True)
    part = build_part("strut_1", Body(frame="strut", reducer="rigid", options=options), ReductionDefaults(), tmp_path)
    assert part.mass_properties().mass == pytest.approx(0.5)
    assert part.positions[0] == pytest.approx([0.0, 0.0, 0.025])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"mass": -1.0, "nodes": {"a": (0, 0, 0)}}, "options.mass: found -1, expected a number above zero"),
        ({"mass": 1.0, "nodes": {}}, "options.nodes: found 0 entries, expected at least 1"),
        ({"mass": 1.0, "nodes": {"a": (0, 0)}}, "options.nodes.a: found 2 entries, expected 3"),
        ({"mass": 1.0, "nodes": {"a": (0, 0, 0)}, "inertia": {"zz": 1.0}}, "principal moments 0, 0, 1"),
        ({"mass": 1.0, "nodes": {"a": (0, 0, 0)}, "center": (0, 0, 0)}, "did you mean 'centre'"),
    ],
)
def test_wrong_options_are_explained(options, words):
    with pytest.raises(prs.DescriptionError, match=words):
        prs.reduce("rigid", **options)
