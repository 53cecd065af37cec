"""Few motions of a part that are to stand for all of them."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array

from prs_model.arrays import FloatArray
from prs_model.complete_order.part import CompletePart, shifted, tied_part
from prs_model.complete_order.subspace import enlarged, pictured, response_space, rigid_motions
from prs_model.description.interface import Interface
from prs_model.finite_elements import FiniteElementModel
from prs_model.linear_algebra import lowest_modes
from prs_model.reduction.interfaces import interface_ties
from prs_model.reduction.recipe import Settings
from prs_model.reduction.surface import skin
from tests.meshes import box, steel

SHIFT = -1e5


def bar() -> FiniteElementModel:
    return steel(box((0.3, 0.1, 0.08), (3, 1, 1)))


def part_of(model: FiniteElementModel, *, grounded: bool = False, **interfaces: str) -> CompletePart:
    selections = {name: Interface(set=each) for name, each in interfaces.items()}
    ties = interface_ties(model, selections, Settings("averaged", "interface", 0))
    return tied_part(model, ties, skin(model), SHIFT, lambda: shifted(model, SHIFT), grounded=grounded)


def squares(mass: FloatArray, stiffness: FloatArray, count: int) -> FloatArray:
    return lowest_modes(mass, stiffness, count)[0]


def test_a_motion_that_no_interface_feels_is_among_them():
    """Beside the part stands another, half as stiff: no load on the interface excites it."""
    one = bar().clamp(["x0"])
    both = FiniteElementModel(
        stiffness=csr_array(block_diag([one.stiffness, one.stiffness / 2.0])),
        mass=csr_array(block_diag([one.mass, one.mass])),
        coordinates=np.vstack([one.coordinates, one.coordinates]),
        dofs=np.vstack([one.dofs, one.dofs + np.array([len(one.coordinates), 0])]),
        node_sets=one.node_sets,
        set_weights=one.set_weights,
    )
    space = response_space(part_of(both, grounded=True, end="x1"), 3)
    lowest = squares(one.mass.toarray(), one.stiffness.toarray(), 1) / 2.0
    assert squares(space.mass, space.stiffness, 1) == pytest.approx(lowest, rel=0.1)


def test_enlarging_by_known_motions_adds_nothing():
    space = response_space(part_of(bar(), end="x1"), 2)
    assert enlarged(space, space.vectors[:, 3:9] @ np.diag([1e3, 1.0, 1e-6, 1.0, 1.0, 1.0])).size == space.size


def test_rigid_coordinates_are_the_motion_of_the_origin():
    part = part_of(bar(), end="x1")
    shapes = np.random.default_rng(1).standard_normal((part.size, 4))
    element = pictured(enlarged(rigid_motions(part), shapes))
    assert element.rigid_body_modes() == pytest.approx(np.eye(10, 6), abs=1e-9)
    whole = part.model.mass_properties()
    assert element.mass_properties().mass == pytest.approx(whole.mass, rel=1e-9)
    assert element.mass_properties().centre == pytest.approx(whole.centre, abs=1e-9)
