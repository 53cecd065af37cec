"""A contact that travels along a part: exact rigid motion at every value, smooth and accurate in between."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

import prs_model as prs
from prs_model.description.schema import Interface
from prs_model.finite_elements import FiniteElementModel
from prs_model.finite_elements.rigid_motion import transfer
from prs_model.reduction import SuperElement, TravellingElement
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
from prs_model.reduction.stations import reduce_travelling
from tests.meshes import box, steel

STATIONS = (0.1, 0.2, 0.3, 0.4, 0.5)


@pytest.fixture(scope="module")
def rail() -> FiniteElementModel:
    return steel(box((0.6, 0.08, 0.06), (24, 2, 1)))


def interfaces(method: str, coupling: str, **travel: object) -> dict[str, Interface]:
    contact = {
        "set": "z1",
        "box": {"x": (-0.05, 0.05)},
        "coupling": coupling,
        "travel": {"joint": "slide", "along": (2.0, 0.0, 0.0), "stations": STATIONS, "method": method} | travel,
    }
    return {
        "left": Interface(set="x0"),
        "contact": Interface.model_validate(contact),
        "right": Interface(set="x1"),
    }


@pytest.fixture(scope="module", params=[("reduced", "rigid"), ("reduced", "averaged"), ("stations", "averaged")])
def element(request: pytest.FixtureRequest, rail: FiniteElementModel) -> TravellingElement:
    return reduce_travelling(rail, interfaces(*request.param), Settings("rigid", "joint", 2))


def loaded_frequencies(element: SuperElement) -> np.ndarray:
    """Lowest frequencies [Hz] of the rail held at its left end, with 5 kg riding on the contact."""
    contact = element.motions[element.node("contact")][:3]
    free = np.setdiff1d(np.arange(element.size), np.flatnonzero(element.motions[element.node("left")].any(axis=0)))
    mass = element.mass + 5.0 * contact.T @ contact
    values = eigh(element.stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(values[:4]) / (2.0 * np.pi)


@pytest.mark.parametrize("value", [0.1, 0.137, 0.25, 0.5])
def test_rigid_motions_are_exact_everywhere(element, rail, value):
    here = element.at(value)
    here.check()
    phi = element.elements[0].rigid_body_modes()
    assert here.rigid_body_modes() == pytest.approx(phi, abs=1e-11)
    assert np.linalg.norm(here.stiffness @ phi) < 1e-11 * np.linalg.norm(here.stiffness) * np.linalg.norm(phi)
    assert here.positions[here.node("contact")] == pytest.approx([value, 0.04, 0.06], abs=1e-9)
    assert here.motions @ phi == pytest.approx(transfer(here.positions), abs=1e-10)
    assert here.mass_properties().mass == pytest.approx(rail.mass_properties().mass, rel=1e-9)


def test_stations_are_met_exactly(element):
    for value, there in zip(element.stations, element.elements, strict=True):
        here = element.at(value)
        assert here.stiffness == pytest.approx(there.stiffness, rel=1e-9, abs=1e-9 * np.abs(there.stiffness).max())
        assert here.motions == pytest.approx(there.motions, abs=1e-12)
        assert here.surface.recovery == pytest.approx(there.surface.recovery, abs=1e-6)


@pytest.mark.parametrize("count", [2, 3, 5, 6, 9])
def test_weights_are_splines_of_degree_five_or_as_high_as_stations_allow(element, count):
    """Polynomials of that degree are met everywhere; a cubic would meet the third only."""
    here = replace(
        element, stations=np.linspace(0.1, 0.5, count), elements=(element.elements[0],) * count, products=None
    )
    values = np.linspace(0.1, 0.5, 401)
    weights = np.array([here.weights(value) for value in values])
    for degree in range(min(5, count - 1) + 1):
        assert weights @ here.stations**degree == pytest.approx(values**degree, abs=1e-13)


def test_frequencies_follow_the_stroke_without_jumps(element):
    """Second differences over 2.5 mm steps stay small: facets that come and go would show as jumps of 1 %."""
    path = np.array([loaded_frequencies(element.at(value)) for value in np.arange(0.2, 0.4, 0.0025)])
    second = np.abs(np.diff(path, n=2, axis=0)) / path[1:-1]
    assert second.max() < 2e-3
    assert np.abs(np.diff(path, axis=0)).max() > 0.0


def test_midway_it_is_the_part_reduced_there(rail):
    spline = reduce_travelling(rail, interfaces("reduced", "averaged"), Settings("rigid", "joint", 4)).at(0.25)
    there = interfaces("reduced", "averaged")
    there["contact"] = Interface.model_validate({"set": "z1", "box": {"x": (0.2, 0.3)}, "coupling": "averaged"})
    exact = reduce_model(rail, there, Settings("rigid", "joint", 4))
    assert loaded_frequencies(spline) == pytest.approx(loaded_frequencies(exact), rel=5e-3)


def test_both_methods_agree(rail):
    ways = [
        reduce_travelling(rail, interfaces(method, "averaged"), Settings("rigid", "joint", 8)).at(0.3)
        for method in ("reduced", "stations")
    ]
    one, other = (loaded_frequencies(way) for way in ways)
    assert one[:3] == pytest.approx(other[:3], rel=5e-3)


@pytest.mark.parametrize(
    ("coupling", "stations", "low", "high"),
    [("averaged", STATIONS, -0.01, 0.0), ("rigid", (0.1, 0.201, 0.302, 0.403), 0.1, 0.6)],
)
def test_the_price_of_method_stations(rail, coupling, stations, low, high):
    """Midway between stations: within 1 % where averaged; rigid contacts side by side stiffen all of the rail."""
    element = reduce_travelling(
        rail, interfaces("stations", coupling, stations=stations), Settings("rigid", "joint", 8)
    )
    value = (stations[1] + stations[2]) / 2.0
    there = interfaces("reduced", coupling)
    here = {"set": "z1", "box": {"x": (value - 0.05, value + 0.05)}, "coupling": coupling}
    there["contact"] = Interface.model_validate(here)
    exact = reduce_model(rail, there, Settings("rigid", "joint", 8))
    error = loaded_frequencies(element.at(value)) / loaded_frequencies(exact) - 1.0
    assert low < error.min() <= error.max() < high


def test_stations_further_apart_than_a_rigid_contact_is_long_are_noted(rail, caplog):
    with caplog.at_level("WARNING", logger="prs_model"):
        reduce_travelling(rail, interfaces("reduced", "rigid"), Settings("rigid", "joint", 0))
        assert not caplog.text
        far = interfaces("reduced", "rigid", stations=(0.1, 0.2, 0.35, 0.5))
        reduce_travelling(rail, far, Settings("rigid", "joint", 0))
    assert "stations of contact are up to 0.15 m apart, its rigid contact is 0.1 m long" in caplog.text


def test_modes_keep_their_order_and_sign_from_station_to_station(rail):
    element = reduce_travelling(rail, interfaces("reduced", "averaged"), Settings("rigid", "joint", 4))
    assert element.nodes == ("left", "contact", "right")
    assert element.labels[5:7] == ("left.rz", "contact.ux")
    assert element.labels[-1] == "mode 4"
    recoveries = [each.surface.recovery[:, :, -4:] for each in element.elements]
    for one, other in itertools.pairwise(recoveries):
        likeness = np.einsum("pim,pim->m", one, other)
        assert np.all(likeness > 0.0)


def test_members_travel_together(rail):
    two = {
        "tie": "interface",
        "coupling": "averaged",
        "members": tuple(
            {"name": f"c{i}", "set": "z1", "box": {"x": (x, x + 0.04)}, "at": (x + 0.02, 0.04, 0.06)}
            for i, x in ((1, -0.05), (2, 0.01))
        ),
        "travel": {"joint": "slide", "along": (1.0, 0.0, 0.0), "stations": STATIONS},
    }
    ends = {"left": Interface(set="x0"), "contact": Interface.model_validate(two)}
    here = reduce_travelling(rail, ends, Settings("rigid", "joint", 2)).at(0.33)
    assert here.nodes == ("left", "contact.c1", "contact.c2")
    assert here.positions[1:] == pytest.approx(np.array([[0.30, 0.04, 0.06], [0.36, 0.04, 0.06]]))
    here.check()


@pytest.mark.parametrize(("coupling", "allowed"), [("rigid", 0.1), ("averaged", 0.01)])
def test_in_between_it_is_as_soft_as_the_part(rail, coupling, allowed):
    """Static compliance of the contact and of the far end, left end held, midway against a reduction there.

    Rigid contacts 100 mm long and 50 mm off a held end are off by 9 % along the rail, where they are very stiff.
    """
    spline = reduce_travelling(rail, interfaces("reduced", coupling), Settings("rigid", "joint", 6))
    for value in (0.25, 0.35):
        there = interfaces("reduced", coupling)
        here = {"set": "z1", "box": {"x": (value - 0.05, value + 0.05)}, "coupling": coupling}
        there["contact"] = Interface.model_validate(here)
        exact, found = (
            np.linalg.inv(each.stiffness[6:, 6:])[:12, :12]
            for each in (reduce_model(rail, there, Settings("rigid", "joint", 6)), _at_node(spline.at(value)))
        )
        size = np.sqrt(np.diag(exact))
        error = np.abs((found - exact) / np.outer(size, size))
        assert error.max() < allowed
        assert error[6:, 6:].max() < 1e-3  # the far end


def _at_node(element: SuperElement) -> SuperElement:
    """The element in coordinates that are the motions of its nodes themselves."""
    count = 6 * len(element.nodes)
    change = np.eye(element.size)
    change[:count, :count] = np.linalg.inv(element.motions.reshape(count, -1)[:, :count])
    return replace(
        element, stiffness=change.T @ element.stiffness @ change, mass=change.T @ element.mass @ change,
        motions=element.motions @ change,
    )  # fmt: skip


def test_a_damaged_mass_between_stations_is_noticed(rail):
    element = reduce_travelling(rail, interfaces("reduced", "averaged"), Settings("rigid", "joint", 2))
    element.check()
    between = element.products.copy()
    between[0, 1] *= 1.01
    between[1, 0] *= 1.01
    with pytest.raises(prs.PhysicsError, match="mass between stations meets theirs"):
        replace(element, products=0.0 * element.products).check()
    with pytest.raises(prs.PhysicsError, match="mass is the same everywhere"):
        replace(element, products=between).check()


def test_far_apart_stations_lose_accuracy_but_never_sense():
    """A slender cantilevered rail under a rigid contact, stations as long as the contact: nothing becomes negative."""
    slender = steel(box((0.6, 0.06, 0.04), (24, 2, 1)))
    ends = interfaces("reduced", "rigid", stations=(0.1, 0.25, 0.4, 0.5))
    del ends["right"]
    element = reduce_travelling(slender, ends, Settings("rigid", "joint", 6))
    for value in np.linspace(0.1, 0.5, 33):
        element.at(value).check()


def test_a_single_free_contact_needs_something_to_hold_the_part(rail):
    alone = {"contact": interfaces("reduced", "averaged")["contact"]}
    with pytest.raises(prs.PartFileError, match="no other interface and no ground"):
        reduce_travelling(rail, alone, Settings("rigid", "joint", 2))
    clamped = reduce_travelling(rail.clamp(["z0"]), alone, Settings("rigid", "joint", 2), grounded=True)
    clamped.check()


def test_what_cannot_travel_is_explained(rail):
    element = reduce_travelling(rail, interfaces("reduced", "averaged"), Settings("rigid", "joint", 0))
    with pytest.raises(prs.PrsError, match=r"travels with joint slide from 0.1 to 0.5, asked for 0.6"):
        element.at(0.6)
    cases = (
        (interfaces("reduced", "rigid", along=(0.0, 0.0, 0.0)), "found \\(0, 0, 0\\), expected a direction"),
        (interfaces("reduced", "rigid", stations=(0.1, 0.2, 0.3, 0.9)), "interfaces.contact: no node is in all of"),
        (interfaces("stations", "rigid", stations=(0.1, 0.15, 0.2, 0.3)), "contact@1 and contact@2 share 25 nodes"),
    )
    for wrong, words in cases:
        with pytest.raises(prs.PartFileError, match=words):
            reduce_travelling(rail, wrong, Settings("rigid", "joint", 0))
