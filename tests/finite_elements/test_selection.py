"""What the words of an interface select, and what is said when they select nothing."""

from dataclasses import replace

import numpy as np
import pytest

from prs_model.description.schema import Selection
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.finite_elements.selection import select
from tests.meshes import box, steel


@pytest.fixture(scope="module")
def model():
    return steel(box((0.4, 0.2, 0.1), (4, 2, 1)))


def selection(**entries):
    return Selection.model_validate(entries, context={"units": Units()})


def test_a_set_comes_with_its_areas(model):
    indices, weights = model.select(selection(set="x1"))
    assert np.allclose(model.coordinates[indices, 0], 0.4)
    assert weights.sum() == pytest.approx(0.02)
    assert np.average(model.coordinates[indices], axis=0, weights=weights) == pytest.approx([0.4, 0.1, 0.05])


def test_ways_of_naming_are_intersected_and_boxes_move(model):
    patch = selection(set="z1", box={"x": (-0.05, 0.05)})
    for shift in (0.1, 0.3):
        indices, _ = select(model, patch, shift=(shift, 0.0, 0.0))
        x = model.coordinates[indices, 0]
        assert np.allclose(model.coordinates[indices, 2], 0.1)
        assert (x.min(), x.max()) == pytest.approx((shift - 0.05, shift + 0.05))


def test_labels_and_cylinders(model):
    labelled = replace(model, node_ids=np.arange(len(model.coordinates), 0, -1))
    count = len(model.coordinates)
    assert labelled.select(selection(nodes=(3, "5")))[0].tolist() == [count - 5, count - 3]
    rim = {"point": (0.0, 0.0, 0.0), "axis": (0.0, 0.0, 2.0), "radius": 0.2, "tolerance": 1e-6, "length": (0.05, 1.0)}
    indices, _ = model.select(selection(cylinder=rim))
    assert np.allclose(np.hypot(*model.coordinates[indices, :2].T), 0.2)
    assert model.coordinates[indices, 2].min() >= 0.05


def test_clamped_nodes_are_no_longer_there(model):
    clamped = model.clamp(["x0"])
    assert clamped.size == model.size - 3 * len(model.node_sets["x0"])
    assert model.clamp([]).size == model.size
    assert clamped.mass_properties().mass < model.mass_properties().mass


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"set": "x0 "}, r"interfaces.a.set: found node set 'x0 ', expected one of x0, .*did you mean 'x0'"),
        ({"nodes": (7, 999999)}, r"interfaces.a.nodes: found node '999999', expected a node of the part \(\d+ of them"),
        ({"set": "x0", "box": {"x": (0.1, 0.2)}}, r"set 'x0' \d+, box \(.*\) \d+; set 'x0' reaches from \(0, 0, 0\)"),
        (
            {"box": {"x": (300.0, 400.0)}},
            r"box \(x 300 to 400 m\) 0; the part reaches from \(0, 0, 0\) to \(0.4, 0.2, 0.1\) m; lengths are in m in",
        ),
        ({}, "no nodes named"),
    ],
)
def test_nothing_selected_is_explained(model, entries, words):
    labelled = replace(model, node_ids=np.arange(1, len(model.coordinates) + 1))
    with pytest.raises(PartFileError, match=words):
        select(labelled, selection(**entries), entry="interfaces.a")


def test_an_interface_may_not_be_clamped_away(model):
    with pytest.raises(PartFileError, match="all its nodes are clamped"):
        model.clamp(["x0"]).select(selection(set="x0"))
    with pytest.raises(PartFileError, match=r"clamped: found node set 'foot'"):
        model.clamp(["foot"])
