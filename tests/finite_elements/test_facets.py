"""The area that a box cuts out of a surface: exact, smooth in where the box is, and today's weights on whole facets."""

from dataclasses import replace

import numpy as np
import pytest

from prs_model.description.interface import Interface, Selection
from prs_model.errors import PrsError
from prs_model.finite_elements import FiniteElementModel
from prs_model.finite_elements.selection import select, select_area
from prs_model.reduction.coupling import Tie, averaging_matrix, check_ties
from prs_model.reduction.interfaces import interface_ties
from prs_model.reduction.recipe import Settings
from tests.meshes import box, steel

SIZE = np.array([0.4, 0.2, 0.1])
PATCH = {"set": "z1", "box": {"x": (-0.06, 0.06), "y": (0.03, 0.17)}}


@pytest.fixture(scope="module", params=[True, False], ids=["quadratic", "linear"])
def model(request: pytest.FixtureRequest) -> FiniteElementModel:
    return steel(box(tuple(SIZE), (4, 2, 1), quadratic=request.param))


def patch(model: FiniteElementModel, x: float, named: dict = PATCH) -> tuple[np.ndarray, np.ndarray]:
    return select_area(model, Selection.model_validate(named), shift=(x, 0.0, 0.0))


def motion(model: FiniteElementModel, x: float) -> np.ndarray:
    """D (6, n) of the patch about a point that moves with it."""
    return averaging_matrix(model, Tie("patch", *patch(model, x), np.array([x, 0.1, 0.1]), "averaged")).toarray()


@pytest.mark.parametrize("x", [0.06, 0.1, 0.113, 0.149, 0.2, 0.3377])
def test_area_and_centre_are_exact_wherever_the_box_is(model, x):
    indices, weights = patch(model, x)
    assert weights.sum() == pytest.approx(0.12 * 0.14, rel=1e-12)
    assert weights @ model.coordinates[indices] / weights.sum() == pytest.approx([x, 0.1, 0.1], rel=1e-12)


@pytest.mark.parametrize("x", [0.06, 0.113, 0.149])
def test_second_moments_are_those_of_the_patch_so_that_negative_weights_do_no_harm(x):
    model = steel(box(tuple(SIZE), (4, 2, 1)))
    indices, weights = patch(model, x)
    assert weights.min() < 0.0
    arms = model.coordinates[indices] - [x, 0.1, 0.1]
    expected = 0.12 * 0.14 / 12.0 * np.diag([0.12**2, 0.14**2, 0.0])
    assert arms.T @ (arms * weights[:, None]) == pytest.approx(expected, rel=1e-10, abs=1e-18)


def test_the_averaged_motion_is_continuous_in_the_shift(model):
    """Steps of a ten-thousandth of an element change D by as little; picked nodes change it by all it is."""
    wide = range(0, 10000, 125)
    changes = [np.abs(motion(model, 0.1 + i * 1e-5) - motion(model, 0.1 + (i + 1) * 1e-5)).max(axis=1) for i in wide]
    size = np.abs(motion(model, 0.1)).max(axis=1)
    assert np.all(np.max(changes, axis=0) < 1e-3 * size)
    assert np.all(np.abs(motion(model, 0.1) - motion(model, 0.14)).max(axis=1) > 0.05 * size)


def test_a_box_along_element_edges_has_the_weights_of_whole_facets(model):
    along = Selection.model_validate({"set": "z1", "box": {"x": (0.1, 0.3)}})
    indices, weights = select_area(model, along)
    end = model.coordinates[:, 0]
    inside, shares = model.node_sets["z1"], model.set_weights["z1"]
    interior = inside[(end[inside] > 0.1 + 1e-9) & (end[inside] < 0.3 - 1e-9) & (shares > 0.0)]
    place = np.searchsorted(indices, interior)
    assert np.array_equal(indices[place], interior)
    assert weights[place] == pytest.approx(shares[np.isin(inside, interior)], rel=1e-12)
    assert np.all((end[indices] > 0.1 - 1e-9) & (end[indices] < 0.3 + 1e-9) & (weights > 0.0))
    everywhere = Selection.model_validate({"set": "z1", "box": {"x": (0.0, 0.4)}})
    indices, weights = select_area(model, everywhere)
    assert np.array_equal(indices, inside[shares > 0.0])
    assert weights == pytest.approx(shares[shares > 0.0], rel=1e-12)


def test_fine_and_coarse_meshes_average_the_same():
    """A smooth field over a patch narrower than an element of the coarse mesh, in which no node need be."""
    narrow = {"set": "z1", "box": {"x": (-0.02, 0.02), "y": (0.06, 0.12)}}
    found = []
    for cells in ((4, 2, 1), (16, 8, 2)):
        model = steel(box(tuple(SIZE), cells))
        tie = Tie("patch", *patch(model, 0.151, narrow), np.array([0.151, 0.09, 0.1]), "averaged")
        check_ties(model, [tie])
        x, y, z = model.coordinates.T
        field = np.column_stack([np.sin(2.0 * x), x * y, np.cos(3.0 * x + y) * z])
        found.append(averaging_matrix(model, tie) @ field.ravel())
    x, y = 0.151, 0.09
    assert found[0][:3] == pytest.approx(found[1][:3], rel=2e-3)
    assert found[1][:3] == pytest.approx([np.sin(2.0 * x), x * y, np.cos(3.0 * x + y) * 0.1], rel=2e-3)


def test_the_ends_of_a_cylinder_cut_as_a_box_does():
    """A quarter bore of 0.1 m, between two heights: chords of the facets instead of arcs."""

    def bored(points: np.ndarray) -> np.ndarray:
        angle, radius = (1.0 - points[:, 0]) * np.pi / 2.0, 0.1 + points[:, 1]
        return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), points[:, 2]])

    model = steel(box((1.0, 0.1, 0.2), (8, 1, 3), shape=bored))
    bore = {"point": (0.0, 0.0, 0.0), "axis": (0.0, 0.0, 2.0), "radius": 0.1, "tolerance": 1e-3, "length": (0.03, 0.15)}
    indices, weights = patch(model, 0.0, {"cylinder": bore | {"point": (0.0, 0.0, 0.017)}})
    chord = 2.0 * 0.1 * np.sin(np.pi / 32.0)
    assert weights.sum() == pytest.approx(8 * chord * 0.12, rel=1e-12)
    assert weights @ model.coordinates[indices, 2] / weights.sum() == pytest.approx(0.107, rel=1e-12)


def test_rigid_ties_hold_the_nodes_inside_and_averaged_ones_the_area():
    model = steel(box(tuple(SIZE), (4, 2, 1)))
    ends = {"x": (0.08, 0.22), "y": (0.0, 0.2)}
    tie = {
        coupling: interface_ties(
            model,
            {"a": Interface.model_validate({"set": "z1", "box": ends, "coupling": coupling})},
            Settings("rigid", "joint", 0),
        )[0]
        for coupling in ("rigid", "averaged")
    }
    picked = select(model, Selection.model_validate({"set": "z1", "box": ends}))[0]
    assert np.array_equal(tie["rigid"].indices, picked)
    assert np.setdiff1d(tie["averaged"].indices, picked).size > 0
    assert tie["averaged"].position == pytest.approx([0.15, 0.1, 0.1], rel=1e-12)
    assert tie["averaged"].weights.sum() == pytest.approx(0.14 * 0.2, rel=1e-12)


def test_without_facets_or_area_nodes_are_picked():
    model = steel(box(tuple(SIZE), (4, 2, 1)))
    across = {"set": "z1", "box": {"x": (0.08, 0.22)}}
    for part, named in (
        (replace(model, mid_sides=None), across),
        (replace(model, triangles=None, mid_sides=None), across),
        (model, {"set": "z1"}),
        (model, {"set": "z1", "box": {"x": (0.1, 0.1)}}),
        (model, {"set": "z1", "box": {"x": (0.1 + 1e-12, 0.1 + 1e-12)}}),
    ):
        selection = Selection.model_validate(named)
        for one, other in zip(select_area(part, selection), select(part, selection), strict=True):
            assert np.array_equal(one, other)
    with pytest.raises(PrsError, match="no node is in all of"):
        patch(model, 0.0, {"set": "z1", "box": {"x": (0.123, 0.123)}})
    with pytest.raises(PrsError, match=r"mid_sides has shape \(4, 3\), expected \(56, 3\)"):
        replace(model, mid_sides=np.zeros((4, 3), dtype=int))


def test_clamped_nodes_have_no_part_in_it():
    model = steel(box(tuple(SIZE), (4, 2, 1))).clamp(["x0"])
    indices, weights = patch(model, 0.0)
    assert not np.any(np.isin(indices, model.node_sets["x0"]))
    assert 0.0 < weights.sum() < 0.06 * 0.14
