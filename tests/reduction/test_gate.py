"""The physics gate notices what no parser can: each kind of damage by its own check, with advice."""

from dataclasses import replace

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.schema import Interface
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
from tests.meshes import box, steel


@pytest.fixture(scope="module")
def element() -> prs.SuperElement:
    model = steel(box((0.4, 0.1, 0.08), (5, 2, 1)))
    return reduce_model(model, {"a": Interface(set="x0"), "b": Interface(set="x1")}, Settings("rigid", "joint", 2))


def with_entry(matrix: np.ndarray, row: int, column: int, factor: float) -> np.ndarray:
    changed = matrix.copy()
    changed[row, column] *= factor
    changed[column, row] = changed[row, column]
    return changed


def swapped(matrix: np.ndarray) -> np.ndarray:
    order = np.arange(len(matrix))
    order[[1, 3]] = order[[3, 1]]
    return matrix[np.ix_(order, order)]


def rigid_part(element: prs.SuperElement, i: int, j: int) -> np.ndarray:
    """A mass matrix whose rigid-body mass is one in entries (i, j) and (j, i) and zero elsewhere."""
    dual = np.linalg.pinv(element.rigid_body_modes())
    return np.outer(dual[i], dual[j]) + np.outer(dual[j], dual[i])


def test_a_sound_part_passes_and_says_so(element):
    report = element.check()
    assert len(report.checks) == 10
    assert "three equal translational masses" in str(report)
    assert report.subject == element.name


@pytest.mark.parametrize(
    ("damage", "check"),
    [
        (lambda e: {"stiffness": np.triu(e.stiffness)}, "stiffness is symmetric"),
        (lambda e: {"mass": np.tril(e.mass)}, "mass is symmetric"),
        (lambda e: {"mass": with_entry(e.mass, 2, 2, -1.0)}, "mass is not negative"),
        (lambda e: {"stiffness": with_entry(e.stiffness, 8, 8, 0.9)}, "stiffness is not negative"),
        (lambda e: {"stiffness": with_entry(e.stiffness, 8, 8, 1.1)}, "rigid motion is free"),
        (lambda e: {"stiffness": swapped(e.stiffness)}, "rigid motion is free"),
        (lambda e: {"positions": 1000.0 * e.positions}, "rigid motion is free"),
        (lambda e: {"mass": with_entry(e.mass, 1, 1, 1.2)}, "three equal translational masses"),
        (lambda e: {"mass": with_entry(e.mass, 12, 12, 1.2)}, "modal block is as promised"),
        (lambda e: {"mass": np.full_like(e.mass, np.nan)}, "numbers that are not finite"),
        (lambda e: {"motions": np.concatenate([e.motions[:1], e.motions[:1]])}, "nodes follow a rigid motion"),
        (lambda e: {"mass": e.mass + 0.2 * rigid_part(e, 0, 3)}, "rigid mass is that of a body"),
        (lambda e: {"mass": e.mass + 20.0 * rigid_part(e, 5, 5)}, "rigid mass is that of a body"),
        (lambda e: {"grounded": True}, "rigid motion is held"),
    ],
)
def test_each_damage_has_its_check(element, damage, check):
    with pytest.raises(prs.PhysicsError, match=check) as error:
        replace(element, **damage(element)).check()
    assert error.value.figure > error.value.limit
    assert len(error.value.cause) > 20


def test_massless_and_inertialess_parts_are_sound():
    point = prs.reduce("rigid", mass=2.0, nodes={"a": (0.0, 0.0, 0.1)})
    assert point.check().checks
    assert point.mass_properties().inertia == pytest.approx(np.zeros((3, 3)))
    massless = replace(point, mass=np.zeros((6, 6)))
    assert massless.mass_properties().mass == 0.0
    massless.check()


def test_round_off_of_a_statically_determinate_part_is_none():
    """A free part of one node has no stiffness; what another program has written of it may be round-off."""
    model = steel(box((0.4, 0.1, 0.08), (5, 2, 1)))
    for coupling in ("rigid", "averaged"):
        for modes in (0, 3):
            element = reduce_model(model, {"a": Interface(set="x0")}, Settings(coupling, "joint", modes))
            assert not element.stiffness[:6].any()
            element.check()
            noise = np.random.default_rng(0).standard_normal((element.size, element.size))
            replace(element, stiffness=element.stiffness + 1e-5 * (noise + noise.T), provenance={}).check()


def test_one_clamped_node_does_not_hold_a_part():
    model = steel(box((0.4, 0.1, 0.08), (5, 2, 1)))
    model = replace(model, node_sets={**model.node_sets, "corner": model.node_sets["x0"][:1]}).clamp(["corner"])
    element = reduce_model(model, {"a": Interface(set="x1")}, Settings("rigid", "joint", 2), grounded=True)
    with pytest.raises(prs.PhysicsError, match="3 of 6 rigid motions cost no energy: clamp a node set"):
        element.check()


def test_shapes_that_do_not_fit_are_refused(element):
    with pytest.raises(prs.PrsError, match=r"motions has shape \(1, 6, 14\), expected \(2, 6, 14\)"):
        replace(element, motions=element.motions[:1])
    with pytest.raises(prs.PrsError, match="node names are not unique"):
        replace(element, nodes=("a", "a"))
    with pytest.raises(prs.UnknownNameError, match="known: a, b"):
        element.node("c")
