"""The beam reducer: closed forms of beam theory, convergence, rigid motion, and a slow twin of a bent frame."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

import prs_model as prs
from prs_model.description.units import Units
from prs_model.finite_elements import FiniteElementModel
from prs_reducers.beam import BeamOptions, beam_model
from prs_reducers.elements.beam_element import plane_bending
from prs_reducers.elements.beam_sections import Round

E, NU, DENSITY = 2.1e11, 0.3, 7850.0
G = E / 2.6
STEEL = {"E": E, "nu": NU, "density": DENSITY}
SIDE = 0.05
SQUARE = {"kind": "rectangle", "y": SIDE, "z": SIDE, "material": STEEL}
AREA, MOMENT = SIDE**2, SIDE**4 / 12.0
KAPPA = 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU)
FLAT = {"kind": "rectangle", "y": 0.05, "z": 0.02, "material": STEEL}


def bar(elements: int = 8, section: dict[str, Any] = SQUARE, **more: Any) -> dict[str, Any]:
    """Options of a bar 1 m long along x."""
    member = {"between": ("root", "tip"), "section": "bar", "elements": elements, **more}
    return {"nodes": {"root": (0, 0, 0), "tip": (1, 0, 0)}, "sections": {"bar": section}, "members": (member,)}


def model(options: dict[str, Any]) -> FiniteElementModel:
    found = prs.read_part("beam", **options)
    assert isinstance(found, FiniteElementModel)
    return found


def free_rows(found: FiniteElementModel, held: dict[int, list[int]]) -> np.ndarray:
    """Rows that are left when these components of these nodes are held."""
    gone = [found.rows[node, component] for node, components in held.items() for component in components]
    return np.setdiff1d(np.arange(found.size), gone)


def frequencies(found: FiniteElementModel, rows: np.ndarray) -> np.ndarray:
    K, M = (matrix.toarray()[np.ix_(rows, rows)] for matrix in (found.stiffness, found.mass))
    return np.sqrt(eigh(K, M, eigvals_only=True)) / (2.0 * np.pi)


@pytest.mark.parametrize("elements", [2, 5])
def test_the_tip_of_a_cantilever_moves_as_in_the_textbook(elements: int) -> None:
    """L/EA, L^3/3EI + L/kGA, L/GJ, L/EI and the L^2/2EI between them, whatever the number of elements."""
    interfaces = {"root": {"node": "root"}, "tip": {"node": "tip"}}
    element = prs.reduce("beam", **bar(elements, FLAT), interfaces=interfaces, modes=0)
    flexibility = np.linalg.inv(element.stiffness[6:, 6:])
    area, about_y, about_z = 0.05 * 0.02, 0.05 * 0.02**3 / 12.0, 0.05**3 * 0.02 / 12.0
    shear, torsion = 1.0 / (KAPPA * G * area), 0.249 * 0.05 * 0.02**3  # Roark's table: 0.249 at 2.5 to 1
    expected = np.diag([1.0 / (E * area), 0, 0, 1.0 / (G * torsion), 1.0 / (E * about_y), 1.0 / (E * about_z)])
    expected[1, 1], expected[2, 2] = 1.0 / (3.0 * E * about_z) + shear, 1.0 / (3.0 * E * about_y) + shear
    expected[1, 5] = expected[5, 1] = 0.5 / (E * about_z)
    expected[2, 4] = expected[4, 2] = -0.5 / (E * about_y)
    assert np.delete(np.delete(flexibility, 3, 0), 3, 1) == pytest.approx(
        np.delete(np.delete(expected, 3, 0), 3, 1), rel=1e-9, abs=1e-14
    )
    assert flexibility[3, 3] == pytest.approx(expected[3, 3], rel=2e-3)


def test_cantilever_against_beam_theory() -> None:
    """Timoshenko bending 41.69 Hz (twice), torsion 736.5, axial 1293.1: full, and as modes of the reduced part."""
    expected = [41.69, 41.69, 736.5, 1293.1]
    full = model(bar(40))
    assert frequencies(full, free_rows(full, CLAMPED))[[0, 1, 6, 7]] == pytest.approx(expected, rel=1.5e-4)
    reduced = prs.reduce("beam", **bar(40), interfaces={"root": {"node": "root"}}, modes=8)
    fixed = np.sqrt(np.diag(reduced.stiffness)[6:]) / (2.0 * np.pi)
    assert fixed[[0, 1, 6, 7]] == pytest.approx(expected, rel=1.5e-4)


CLAMPED = {0: [0, 1, 2, 3, 4, 5]}


def pinned_bar(side: float, kappa: float) -> float:
    """First frequency [Hz] of a Timoshenko beam on two supports: the smaller root of its quadratic in omega^2."""
    k, area, moment = np.pi, side**2, side**4 / 12.0
    mass, rotary, bending, shear = DENSITY * area, DENSITY * moment, E * moment, kappa * G * area
    terms = [mass * rotary / shear, -(mass + k**2 * (rotary + bending * mass / shear)), bending * k**4]
    return float(np.sqrt(np.min(np.abs(np.roots(terms)))) / (2.0 * np.pi))


UNSHEARED = {"kind": "properties", "A": AREA, "Iy": MOMENT, "Iz": MOMENT, "J": 2.0 * MOMENT, "material": STEEL}
STOCKY = SQUARE | {"y": 0.5, "z": 0.5}
IN_PLANE = [0, 2, 3, 4]


@pytest.mark.parametrize(
    ("section", "held", "others", "exact", "order"),
    [
        (UNSHEARED, [1], IN_PLANE, pinned_bar(SIDE, np.inf), 4),
        (STOCKY, [1], IN_PLANE, pinned_bar(0.5, KAPPA), 2),
        (SQUARE, [0], [1, 2, 3, 4, 5], np.sqrt(E / DENSITY) / 2.0, 2),
        (SQUARE, [3], [0, 1, 2, 4, 5], np.sqrt(G * 0.140577 * 6.0 / DENSITY) / 2.0, 2),  # J, Ip = 0.1406, 1/6 a^4
    ],
    ids=["bending", "bending and shear", "axial", "torsion"],
)
def test_frequencies_converge_from_above(
    section: dict[str, Any], held: list[int], others: list[int], exact: float, order: int
) -> None:
    """Both ends held: h^4 in bending, h^2 where the strain is constant in an element, as in shear."""
    errors = []
    for elements in (4, 8):
        found = model(bar(elements, section))
        gone = {node: others for node in range(elements + 1)} | {node: [*others, *held] for node in (0, 1)}
        errors.append((frequencies(found, free_rows(found, gone))[0] / exact) ** 2 - 1.0)
    assert errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


def test_mass_of_a_beam_without_shear_is_the_printed_one() -> None:
    """rho A L / 420 and rho I / 30 L: Przemieniecki, eq. 11.31; the stiffness of a beam with shear, eq. 5.116."""
    L, mass, rotary = 0.7, 3.0, 0.02
    translation = [[156, 22 * L, 54, -13 * L], [22 * L, 4 * L**2, 13 * L, -3 * L**2]]
    turning = [[36, 3 * L, -36, 3 * L], [3 * L, 4 * L**2, -3 * L, -(L**2)]]
    found = plane_bending(L, 5.0, np.inf, mass, rotary)[1]
    expected = mass * L / 420.0 * np.array(translation) + rotary / (30.0 * L) * np.array(turning)
    assert found[:2] == pytest.approx(expected)
    mirrored = np.diag([1.0, -1.0, 1.0, -1.0])[[2, 3, 0, 1]]
    assert mirrored.T @ found @ mirrored == pytest.approx(found)


def test_a_tube_shears_as_cowper_printed_it() -> None:
    """Cowper 1966, table 1: 2 (1 + nu) / (4 + 3 nu) of a thin tube, 6 (1 + nu) / (7 + 6 nu) of a solid bar."""

    def coefficient(bore: float | None) -> float:
        section = Round.model_validate({"kind": "round", "diameter": 0.1, "bore": bore, "material": STEEL})
        area = np.pi / 4.0 * (0.1**2 - (bore or 0.0) ** 2)
        along_y, along_z = section.properties().shear
        assert along_y == along_z
        return along_y / (G * area)

    assert coefficient(0.0999999) == pytest.approx(2.6 / 4.9, rel=1e-5)
    assert coefficient(None) == pytest.approx(7.8 / 8.8)
    assert coefficient(0.05) == pytest.approx(7.8 * 1.5625 / (8.8 * 1.5625 + 23.6 * 0.25))  # (1 + m^2)^2 = 1.5625


TURN = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
SHIFT = np.array([0.1, -0.2, 0.3])


def bent_frame(turn: np.ndarray = TURN, shift: np.ndarray = SHIFT) -> dict[str, Any]:
    """Two flat bars at a right angle: along x, then along y, turned and moved."""

    def at(x: float, y: float) -> tuple[float, ...]:
        return tuple(turn @ [x, y, 0.0] + shift)

    members = (
        {"between": ("root", "knee"), "section": "flat", "up": tuple(turn[:, 2]), "elements": 2},
        {"between": ("knee", "tip"), "section": "flat", "up": tuple(turn[:, 0]), "elements": 3},
    )
    nodes = {"root": at(0, 0), "knee": at(0.6, 0), "tip": at(0.6, 0.9)}
    return {"nodes": nodes, "sections": {"flat": FLAT}, "members": members}


def test_a_frame_moves_freely_and_weighs_what_its_bars_do() -> None:
    found = model(bent_frame())
    phi = found.rigid_body_modes()
    assert np.linalg.norm(found.stiffness @ phi) < 1e-12 * abs(found.stiffness).max() * np.linalg.norm(phi)
    one, other = DENSITY * 1e-3 * 0.6, DENSITY * 1e-3 * 0.9
    centre = (one * np.array([0.3, 0.0, 0.0]) + other * np.array([0.6, 0.45, 0.0])) / (one + other)
    inertia = np.zeros((3, 3))
    for mass, middle, size in ((one, (0.3, 0, 0), (0.6, 0.05, 0.02)), (other, (0.6, 0.45, 0), (0.02, 0.9, 0.05))):
        arm, squares = np.array(middle) - centre, np.square(size)
        own = mass / 12.0 * (squares.sum() * np.eye(3) - np.diag(squares))
        inertia += own + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    properties = found.mass_properties()
    assert properties.mass == pytest.approx(one + other, rel=1e-12)
    assert properties.centre == pytest.approx(TURN @ centre + SHIFT, rel=1e-12)
    assert properties.inertia == pytest.approx(TURN @ inertia @ TURN.T, rel=1e-10)


def test_a_turned_frame_has_the_same_frequencies() -> None:
    upright = model(bent_frame(np.eye(3), np.zeros(3))).frequencies(12)
    assert model(bent_frame()).frequencies(12)[6:] == pytest.approx(upright[6:], rel=1e-8)


def test_a_bent_frame_like_its_slow_twin() -> None:
    """The 12 x 12 stiffness as printed (Przemieniecki, eq. 5.116), element by element, turned and added by hand."""
    options = bent_frame()
    found = model(options)
    expected = np.zeros((found.size, found.size))
    for start, end, up in ((0, 3, 2), (3, 1, 2), (1, 4, 0), (4, 5, 0), (5, 2, 0)):
        line = found.coordinates[end] - found.coordinates[start]
        x, z = line / np.linalg.norm(line), TURN[:, up]
        axes = np.array([x, np.cross(z, x), z])
        turn = np.kron(np.eye(4), axes)
        rows = np.concatenate([found.rows[start], found.rows[end]])
        expected[np.ix_(rows, rows)] += turn.T @ printed_stiffness(float(np.linalg.norm(line))) @ turn
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert found.stiffness.toarray() / scale == pytest.approx(expected / scale, abs=1e-5)


def printed_stiffness(length: float) -> np.ndarray:
    """The flat bar's, entry by entry."""
    y, z, L = 0.05, 0.02, length
    area, Iy, Iz = y * z, y * z**3 / 12.0, y**3 * z / 12.0
    phi_y, phi_z = (12.0 * E * moment / (KAPPA * G * area * L**2) for moment in (Iz, Iy))
    a, t = E * area / L, G * 0.24936 * y * z**3 / L  # 0.24936: Saint-Venant's series at 2.5 to 1
    K = np.zeros((12, 12))
    K[0, 0], K[0, 6], K[3, 3], K[3, 9] = a, -a, t, -t
    for v, r, sign, moment, phi in ((1, 5, 1.0, Iz, phi_y), (2, 4, -1.0, Iy, phi_z)):
        c = E * moment / (L * (1.0 + phi))
        K[v, v], K[v, v + 6] = 12.0 * c / L**2, -12.0 * c / L**2
        K[v, r] = K[v, r + 6] = sign * 6.0 * c / L
        K[r, r], K[r, v + 6], K[r, r + 6] = (4.0 + phi) * c, -sign * 6.0 * c / L, (2.0 - phi) * c
        K[v + 6, r + 6], K[r + 6, r + 6] = -sign * 6.0 * c / L, (4.0 + phi) * c
        K[v + 6, v + 6] = 12.0 * c / L**2
    K[6, 6], K[9, 9] = a, t
    return np.triu(K) + np.triu(K, 1).T


def test_offsets_are_rigid() -> None:
    """A bar 1 m long between nodes beside its ends is the bar whose end nodes are tied to points beside them."""
    beside = np.array([[0.0, 0.2, 0.1], [-0.1, 0.3, 0.0]])
    options = bar(offsets=tuple(map(tuple, -beside)))
    options["nodes"] = {"root": tuple(beside[0]), "tip": tuple(beside[1] + [1.0, 0.0, 0.0])}
    offset = prs.reduce("beam", **options, interfaces={"a": {"node": "root"}, "b": {"node": "tip"}}, modes=2)
    at = {
        "a": {"nodes": ("root",), "at": options["nodes"]["root"]},
        "b": {"nodes": ("tip",), "at": options["nodes"]["tip"]},
    }
    tied = prs.reduce("beam", **bar(), interfaces=at, modes=2)
    for name in ("stiffness", "mass"):
        wanted = getattr(tied, name)[:12, :12]
        assert getattr(offset, name)[:12, :12] == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())


def test_an_interface_of_several_nodes_is_tied_rigidly() -> None:
    """A fork whose two tips are held together: twice the stiffness of one prong, and a moment arm between them."""
    nodes = {"root_1": (0, 0.1, 0), "root_2": (0, -0.1, 0), "tip_1": (1, 0.1, 0), "tip_2": (1, -0.1, 0)}
    members = [{"between": (f"root_{i}", f"tip_{i}"), "section": "bar"} for i in (1, 2)]
    members.append({"between": ("tip_1", "tip_2"), "section": "bar"})
    interfaces = {"root": {"nodes": ("root_1", "root_2")}, "tip": {"set": "tip_1-tip_2"}}
    element = prs.reduce("beam", nodes=nodes, sections={"bar": SQUARE}, members=members, interfaces=interfaces, modes=0)
    stiffness, axial = element.stiffness[6:, 6:], E * AREA
    shear = 1.0 / (1.0 / (12.0 * E * MOMENT) + 1.0 / (KAPPA * G * AREA))
    assert np.diag(stiffness)[:3] == pytest.approx([2.0 * axial, 2.0 * shear, 2.0 * shear], rel=1e-9)
    assert stiffness[5, 5] == pytest.approx(2.0 * (axial * 0.01 + E * MOMENT + shear / 4.0), rel=1e-9)


def test_a_tapered_bar_stretches_as_its_integral_says() -> None:
    """int dx / EA = 4 L / pi E d0 d1; elements of constant section come near it as h^2."""
    sections = {
        name: {"kind": "round", "diameter": d, "material": STEEL} for name, d in (("bar", 0.06), ("thin", 0.03))
    }
    exact = 4.0 / (np.pi * E * 0.06 * 0.03)
    errors = []
    for elements in (4, 8):
        options = bar(elements, taper_to="thin") | {"sections": sections}
        element = prs.reduce("beam", **options, interfaces={"root": {"node": "root"}, "tip": {"node": "tip"}}, modes=0)
        errors.append(abs(1.0 / element.stiffness[6, 6] / exact - 1.0))
    assert errors[1] < 5e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_masses_on_nodes() -> None:
    head = {"mass": 4.0, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.25}, "centre": (1.0, 0.3, 0.0)}
    found = model(bar() | {"masses": {"tip": head}}).mass_properties()
    beam = DENSITY * AREA
    assert found.mass == pytest.approx(beam + 4.0)
    assert found.centre == pytest.approx([(0.5 * beam + 4.0) / (beam + 4.0), 1.2 / (beam + 4.0), 0.0])
    about_axis = 0.1 + 2.0 * DENSITY * MOMENT + 4.0 * 0.3**2 - (beam + 4.0) * found.centre[1] ** 2
    assert found.inertia[0, 0] == pytest.approx(about_axis)


def test_options_are_in_the_units_of_the_machine() -> None:
    """Areas and their moments too."""
    in_metres = bar(
        2, {"kind": "properties", "A": 2e-3, "Iy": 3e-7, "Iz": 2e-7, "J": 4e-7, "kz": 0.8, "material": STEEL}
    )
    steel = {"E": 2.1e5, "nu": NU, "density": 7.85e-6}
    section = {"kind": "properties", "A": 2e3, "Iy": 3e5, "Iz": 2e5, "J": 4e5, "kz": 0.8, "material": steel}
    in_mm = bar(2, section) | {"nodes": {"root": (0.0, 0.0, 0.0), "tip": (1000.0, 0.0, 0.0)}}
    options = BeamOptions.model_validate(in_mm, context={"units": Units(length="mm")})
    assert beam_model(options).frequencies(12)[6:] == pytest.approx(model(in_metres).frequencies(12)[6:])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"section": "brr"}, r"members\[0\].section: found 'brr', expected a section .*did you mean 'bar'"),
        ({"between": ("root", "tp")}, r"members\[0\].between: found 'tp', expected a node .*did you mean 'tip'"),
        ({"between": ("tip", "tip")}, "found 'tip' twice"),
        ({"up": (1, 0, 0)}, r"members\[0\].up: found a direction that is zero or along local x"),
        ({"offsets": ((1, 0, 0), (0, 0, 0))}, "found a length of zero from root to tip"),
        ({"taper_to": "pipe"}, "found bar and pipe, expected sections of one kind and material"),
    ],
)
def test_wrong_members_are_explained(change: dict[str, Any], words: str) -> None:
    options = bar()
    options["members"] = (options["members"][0] | change,)
    options["sections"]["pipe"] = {"kind": "round", "diameter": 0.1, "bore": 0.05, "material": STEEL}
    with pytest.raises(prs.DescriptionError, match=words):
        prs.reduce("beam", **options, interfaces={"tip": {"node": "tip"}})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"J": 2.1 * MOMENT}, r"J = 1\.05 \(Iy \+ Iz\), expected at most Iy \+ Iz"),
        ({"kz": 1.2}, r"found kz = 1\.2, expected at most 1"),
        ({"material": STEEL | {"G": 8e7}}, r"found G = 0\.000381 E, which no solid has"),
    ],
)
def test_sections_that_do_not_exist_are_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(prs.DescriptionError, match=words):
        model(bar(2, UNSHEARED | change))


def test_a_section_in_other_units_than_the_nodes_is_noticed(caplog: pytest.LogCaptureFixture) -> None:
    """25 x 80 mm read as metres on a bar of 1 m; a disc is no bar, and may be meant."""
    with caplog.at_level(logging.WARNING, logger="prs_model"):
        model(bar(2, SQUARE | {"y": 3.0, "z": 3.0}))
        assert not caplog.messages
        model(bar(2, SQUARE | {"y": 25.0, "z": 80.0}))
    assert caplog.messages == [
        "beam: section 'bar' has a radius of gyration of 23.09 m, the frame is 1 m long; check units"
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"masses": {"tpi": {"mass": 1.0}}}, "options.masses: found 'tpi'.*did you mean 'tip'"),
        ({"nodes": {"root": (0, 0, 0), "tip": (1, 0, 0), "far": (2, 0, 0)}}, "found none that join far to root"),
        ({"sections": {"bar": SQUARE | {"kind": "square"}}}, "found kind 'square', expected one of round"),
        ({"sections": {"bar": SQUARE | {"material": STEEL | {"E": 2.1e5}}}}, "which no solid has"),
        (
            {"nodes": {"root": (0, 0, 0), "tip": (1, 0, 0), "root-tip.1": (2, 0, 0)}},
            "found a name like those of the inner",
        ),
        ({"members": bar(10**9)["members"]}, "less than or equal to 1000"),
        ({"members": bar()["members"] * 2}, "found two members 'root-tip'"),
    ],
)
def test_wrong_frames_are_explained(change: dict[str, Any], words: str) -> None:
    with pytest.raises(prs.DescriptionError, match=words):
        prs.reduce("beam", **(bar() | change), interfaces={"tip": {"node": "tip"}})
