"""The lumped reducer: closed forms of masses on springs, rigid motion, and a chain that converges to a bar."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import prs_model as prs
from prs_model.linear_algebra import lowest_modes
from prs_model.reduction import SuperElement

INERTIA = {"xx": 0.02, "yy": 0.03, "zz": 0.04}
SIX = {"ux": 1e7, "uy": 2e7, "uz": 3e7, "rx": 1e4, "ry": 2e4, "rz": 3e4}
PAIR = {
    "nodes": {"a": (0.1, 0.0, 0.2), "b": (0.3, -0.2, 0.5)},
    "masses": {"a": {"mass": 2.0, "inertia": INERTIA}, "b": {"mass": 3.0, "inertia": INERTIA}},
}


def lumped(**options: Any) -> SuperElement:
    found = prs.read_part("lumped", **options)
    assert isinstance(found, SuperElement)
    return found


def frequencies(element: SuperElement, count: int) -> np.ndarray:
    values = lowest_modes(np.array(element.mass), np.array(element.stiffness), count)[0]
    return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)


def test_two_masses_on_an_axial_spring() -> None:
    """omega^2 = k (1/m1 + 1/m2), along the line of the nodes; points without inertia keep no rotations."""
    masses = {"a": {"mass": 2.0}, "b": {"mass": 3.0}}
    springs = ({"between": ("a", "b"), "axial": 1e6},)
    element = prs.reduce("lumped", nodes=PAIR["nodes"], masses=masses, springs=springs)
    assert element.size == 6
    expected = np.sqrt(1e6 * (1.0 / 2.0 + 1.0 / 3.0)) / (2.0 * np.pi)
    assert frequencies(element, 6) == pytest.approx([0, 0, 0, 0, 0, expected], rel=1e-9, abs=1e-3)


def test_masses_on_the_ground() -> None:
    """Two equal masses in a row between two walls: omega^2 = k/m and 3 k/m; three springs, one along each line."""
    across = {"uy": 1e9, "uz": 1e9, "rx": 1e7, "ry": 1e7, "rz": 1e7}
    at = {"at": (0.5, 0.0, 0.0)}
    element = prs.reduce(
        "lumped",
        nodes={"a": (0.0, 0.0, 0.0), "b": (1.0, 0.0, 0.0)},
        masses={"a": {"mass": 4.0, "inertia": INERTIA}, "b": {"mass": 4.0, "inertia": INERTIA}},
        springs=(
            {"between": ("ground", "a"), "axial": 1e6, "along": (1, 0, 0)},
            {"between": ("a", "b"), "axial": 1e6},
            {"between": ("b", "ground"), "axial": 1e6, "along": (1, 0, 0)},
            {"between": ("ground", "a"), "stiffness": across} | at,
            {"between": ("ground", "b"), "stiffness": across} | at,
        ),
        grounded=True,
    )
    expected = np.sqrt(np.array([1.0, 3.0]) * 1e6 / 4.0) / (2.0 * np.pi)
    assert frequencies(element, 2) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("more", [{}, {"at": (1.0, 2.0, -1.0)}, {"along": (1, 2, 3), "up": (0, 1, 1)}])
@pytest.mark.parametrize("law", ["axes", "matrix"])
def test_springs_do_not_resist_rigid_motion(more: dict[str, Any], law: str) -> None:
    """Wherever it acts, in whatever axes: K phi = 0 to round-off; taking u_b - u_a would not do."""
    factor = np.random.default_rng(1).standard_normal((6, 6))
    stiffness = SIX if law == "axes" else 1e6 * factor @ factor.T
    element = prs.reduce("lumped", **PAIR, springs=({"between": ("a", "b"), "stiffness": stiffness} | more,))
    phi = element.rigid_body_modes()
    assert np.linalg.norm(element.stiffness @ phi) < 1e-14 * np.linalg.norm(element.stiffness) * np.linalg.norm(phi)
    assert np.linalg.matrix_rank(element.stiffness, tol=1e-9 * np.linalg.norm(element.stiffness)) == 6
    subtracted = np.kron(np.array([[1, -1], [-1, 1]]), np.diag(list(SIX.values())))
    assert np.linalg.norm(subtracted @ phi) > 1e-2 * np.linalg.norm(subtracted)


def test_a_spring_gives_where_it_acts() -> None:
    """Held at a, a force at the spring's place moves b by F/k there, and turns nothing; a moment turns b by M/k."""
    place = np.array([0.25, 0.1, 0.3])
    turn = Rotation.from_rotvec([0.3, 0.5, -0.2]).as_matrix()
    spring = {
        "between": ("a", "b"),
        "stiffness": SIX,
        "at": tuple(place),
        "along": tuple(turn[:, 0]),
        "up": tuple(turn[:, 2]),
    }
    element = prs.reduce("lumped", **PAIR, springs=(spring,))
    flexibility = np.linalg.inv(element.stiffness[6:, 6:])
    arm = place - np.array(PAIR["nodes"]["b"])
    for axis in range(3):
        direction = turn[:, axis]
        force = np.concatenate([direction, np.cross(arm, direction)])
        motion = flexibility @ force
        assert motion[3:] == pytest.approx(np.zeros(3), abs=1e-16)
        assert motion[:3] == pytest.approx(direction / list(SIX.values())[axis], rel=1e-9, abs=1e-16)
        moment = flexibility @ np.concatenate([np.zeros(3), direction])
        assert moment[3:] == pytest.approx(direction / list(SIX.values())[3 + axis], rel=1e-9, abs=1e-13)


def test_mass_properties_are_those_of_the_lumps() -> None:
    masses = {"a": {"mass": 2.0, "inertia": INERTIA, "centre": (0.0, 0.0, 0.0)}, "b": PAIR["masses"]["b"]}
    element = lumped(nodes=PAIR["nodes"], masses=masses, springs=({"between": ("a", "b"), "stiffness": SIX},))
    found, places = element.mass_properties(), np.array([[0.0, 0.0, 0.0], PAIR["nodes"]["b"]])
    centre = (2.0 * places[0] + 3.0 * places[1]) / 5.0
    inertia = 2.0 * np.diag([0.02, 0.03, 0.04])
    for mass, arm in zip((2.0, 3.0), places - centre, strict=True):
        inertia += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert found.mass == pytest.approx(5.0)
    assert found.centre == pytest.approx(centre)
    assert found.inertia == pytest.approx(inertia)


def chain(pieces: int) -> dict[str, Any]:
    """A bar of unit stiffness EA, mass and length: lumps where its pieces meet, axial springs between them."""
    h = 1.0 / pieces
    nodes = {f"n{i}": (i * h, 0.0, 0.0) for i in range(pieces + 1)}
    masses = {name: {"mass": h if 0 < i < pieces else h / 2.0} for i, name in enumerate(nodes)}
    springs = tuple({"between": (f"n{i}", f"n{i + 1}"), "axial": pieces * 1.0} for i in range(pieces))
    return {"nodes": nodes, "masses": masses, "springs": springs}


def test_a_chain_converges_to_the_bar() -> None:
    """Free-free bar: f = 1/2 (c = L = 1); n lumped pieces have n/pi sin(pi/2n), from below and as h^2."""
    errors = []
    for pieces in (4, 8):
        found = frequencies(lumped(**chain(pieces)), 3 * (pieces + 1))
        first = found[found > 1e-3][0]
        assert first == pytest.approx(pieces / np.pi * np.sin(np.pi / 2.0 / pieces), rel=1e-9)
        errors.append(0.5 - first)
    assert errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_inner_motions_without_a_spring_are_told(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, logger="prs_model"):
        lumped(**PAIR, springs=({"between": ("a", "b"), "stiffness": SIX},))
        assert not caplog.messages
        lumped(**PAIR, springs=({"between": ("a", "b"), "stiffness": SIX | {"rz": 0.0, "ry": 0.0}},))
    assert "2 motions of its nodes meet no spring" in caplog.text


def test_the_ground_is_declared() -> None:
    springs = ({"between": ("a", "b"), "stiffness": SIX}, {"between": ("ground", "a"), "stiffness": SIX})
    with pytest.raises(prs.PhysicsError, match="say 'grounded: true'"):
        prs.reduce("lumped", **PAIR, springs=springs)
    assert prs.reduce("lumped", **PAIR, springs=springs, grounded=True).grounded
    with pytest.raises(prs.PhysicsError, match="6 of 6 rigid motions cost no energy"):
        prs.reduce("lumped", **PAIR, springs=springs[:1], grounded=True)


@pytest.mark.parametrize(
    ("springs", "words"),
    [
        ([], "options.springs: found none that join b to a"),
        ([{"axial": 1.0, "stiffness": SIX}], "found both or neither, expected 'axial' or 'stiffness'"),
        ([{"stiffness": SIX | {"ux": "rigid"}}], "stiffness: found rigid, expected a number"),
        ([{"stiffness": np.diag([1.0, 1, 1, 1, 1, -1])}], "found a matrix with a negative eigenvalue"),
        ([{"stiffness": np.eye(6) + np.eye(6, k=3)}], "expected a symmetric matrix"),
        ([{"stiffness": SIX, "along": (1, 0, 0), "up": (2, 0, 0)}], r"springs\[0\].up: found a direction that is zero"),
        ([{"stiffness": SIX, "up": (0, 0, 1)}], "found no 'along' beside it"),
        ([{"axial": 1.0, "between": ("a", "c")}], r"found 'c', expected a node \(a, b, ground\)"),
        ([{"axial": 1.0, "between": ("a", "ground")}], "found no 'along'"),
        ([{"axial": 1.0, "at": (0, 0, 0)}], "it acts on the line of its nodes"),
    ],
)
def test_wrong_springs_are_explained(springs: list[dict[str, Any]], words: str) -> None:
    between = {"between": ("a", "b")}
    with pytest.raises(prs.DescriptionError, match=words):
        prs.reduce("lumped", **PAIR, springs=[between | spring for spring in springs])
