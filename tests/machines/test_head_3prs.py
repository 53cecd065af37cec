"""The assembled 3-PRS head: the paper's bookkeeping, frequencies and mode characters, symmetry, smoothness along the
stroke, and its spherical joint."""

import numpy as np
import pytest

import prs_model as prs
from prs_model.arrays import FloatArray

# Table 3 of the paper, semi-analytical column [Hz]
TABLE_3 = np.array([57.84, 59.56, 142.99, 155.84, 215.65, 226.93, 238.68, 274.22])


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs")


@pytest.fixture(scope="module")
def paper(head: prs.Machine) -> prs.Machine:
    """The paper's setting: rigid interfaces, one node per joint."""
    return head.replace({"reduction.method": "craig-bampton"})


@pytest.fixture(scope="module")
def paper_modes(paper: prs.Machine) -> prs.Modes:
    return paper.modes(8)


def test_bookkeeping_of_the_paper(paper: prs.Machine) -> None:
    """25 condensation nodes of six coordinates and 11 components of three modes (section 3.3)."""
    index = paper.assemble().index
    modal = [row for row in index if row.dof.startswith("mode")]
    nodes = {(row.body, row.node) for row in index if not row.dof.startswith("mode")}
    assert (len(index), len(nodes), len(modal)) == (183, 25, 33)


def test_rigid_seats_are_eliminated_exactly(paper: prs.Machine) -> None:
    """165 coordinates remain, and the frequencies are the limit of ever stiffer seats, from below."""
    rigid = paper.replace({"joints.seat": dict(per="limb", frame="board_<limb>", between=SEAT, rigid=True)}).assemble()
    assert rigid.size == 165
    limit = rigid.modes(8).frequencies
    errors = []
    for factor in (1e1, 1e2, 1e3):
        axes = paper.description.joints["seat_1"].stiffness
        stiff = {axis: getattr(axes, axis) * factor / unit for axis, unit in SEAT_UNITS.items()}
        changed = paper.replace({"joints.seat.stiffness": stiff}).modes(8).frequencies
        assert np.all(changed < limit)
        errors.append(np.max(limit / changed - 1.0))
    assert errors[1] / errors[0] == pytest.approx(0.1, rel=0.1)
    assert errors[2] / errors[1] == pytest.approx(0.1, rel=0.1)


SEAT = ("base.seat_<limb>", "board_<limb>.seat")
SEAT_UNITS = {"ux": 1e3, "uy": 1e3, "uz": 1e3, "rx": 1e-3, "ry": 1e-3, "rz": 1e-3}  # N/mm and N mm in SI


def test_first_eight_frequencies_are_a_fair_reconstruction(paper_modes: prs.Modes) -> None:
    np.testing.assert_allclose(paper_modes.frequencies, TABLE_3, rtol=0.05)


def slider_strokes(modes: prs.Modes) -> FloatArray:
    """(3, k): how far each slider moves along its own axis."""
    strokes = []
    for body in ("slider_1", "slider_2", "slider_3"):
        element = modes.system.elements[body]
        strokes.append((element.motions[element.node("carriages")] @ modes.body_shapes(body))[2])
    return np.array(strokes)


def test_modes_have_the_characters_of_the_paper(paper_modes: prs.Modes) -> None:
    """Section 4: 1, 2 lateral; 3, 4 torsion; 5 sliders in phase; 6, 7 out of phase; 8 bending of the rods."""
    characters = paper_modes.characters()
    assert [each.group for each in characters] == ["platform"] * 3 + ["base"] + ["platform"] * 3 + ["rod"]
    assert {characters[0].motion[:7], characters[1].motion[:7]} == {"along u", "along v"}
    assert characters[2].motion == "about w"
    assert characters[4].motion == "along w"
    assert characters[7].motion.endswith("their x out of phase")
    assert all(share > 0.9 for share in paper_modes.kinetic_energy()["platform"][:2])

    strokes, tool = slider_strokes(paper_modes), paper_modes.output_shapes
    in_phase, spread = strokes.mean(axis=0), np.ptp(strokes, axis=0)
    assert abs(in_phase[4]) > 100 * spread[4]
    for mode in (5, 6):
        assert spread[mode] > 100 * abs(in_phase[mode])
    for mode in (2, 3):  # the platform turns about w, at the rods' ends far more than the tool point moves
        assert np.linalg.norm(tool[:3, mode]) < 1e-3 * 0.165 * abs(tool[5, mode])


def test_the_tool_point_is_at_rest_in_modes_3_4_and_8(paper_modes: prs.Modes) -> None:
    """Section 4: the dynamic responses there "in the 3rd, 4th, and 8th orders are essentially zero"."""
    flexibility = paper_modes.output_shapes[:3] ** 2 / paper_modes.eigenvalues
    share = flexibility / flexibility.sum(axis=1, keepdims=True)
    assert np.all(share[:, [2, 3, 7]] < 0.01)
    assert share[2, 4] > 0.7  # the in-phase mode of the sliders is the weak one along w


def test_strain_sits_in_rods_and_spherical_joints_little_in_the_base(paper_modes: prs.Modes) -> None:
    """Modes 1 and 2, figure 17."""
    shares: dict[str, FloatArray] = {}
    for name, share in paper_modes.strain_energy().items():
        group = name.rsplit("_", 1)[0]
        shares[group] = shares.get(group, 0.0) + share[:2]
    assert np.all(shares["rod"] > 0.3)
    assert np.all(shares["S"] > shares["P"])
    assert np.all(shares["base"] < 0.1)


@pytest.mark.parametrize("pose", [(0.0, 0.0), (0.2, 0.3), (0.5, 1.9)])
def test_identical_limbs_make_a_threefold_symmetry(head: prs.Machine, pose: tuple[float, float]) -> None:
    nutation, precession = pose
    turned = [head.modes(8, nutation=nutation, precession=precession + k * 2 * np.pi / 3).frequencies for k in range(3)]
    np.testing.assert_allclose(turned[1], turned[0], rtol=1e-5)
    np.testing.assert_allclose(turned[2], turned[0], rtol=1e-5)


@pytest.mark.parametrize("method", ["joint-loaded", "craig-bampton"])
def test_nothing_jumps_along_the_stroke(head: prs.Machine, method: str) -> None:
    """10 mm in steps of 0.5 mm: a contact that picked facets anew would jump by 1-2 %."""
    machine = head.replace({"reduction.method": method})
    z = 1.270 + 0.0005 * np.arange(21)
    frequencies = np.array([machine.modes(8, z=height).frequencies for height in z])
    second = np.diff(frequencies, 2, axis=0) / frequencies.mean(axis=0)
    assert np.max(np.abs(second)) < 1e-5
    assert np.max(np.abs(np.diff(second, axis=0))) < 1e-6


def test_the_printed_spherical_joint_is_stiffer(head: prs.Machine) -> None:
    """Eq. (14) to the letter resists the three free rotations."""
    sound = head.modes(8).frequencies
    printed = head.replace({"joints.S.as_printed": True}).modes(8).frequencies
    assert np.all(printed > sound)
    assert np.all(printed[:3] > 1.05 * sound[:3])


def test_energy_shares_sum_to_one(head: prs.Machine) -> None:
    modes = head.modes(8, nutation=0.3, precession=0.7)
    np.testing.assert_allclose(sum(modes.kinetic_energy().values()), 1.0, atol=1e-12)
    np.testing.assert_allclose(sum(modes.strain_energy().values()), 1.0, atol=1e-12)
