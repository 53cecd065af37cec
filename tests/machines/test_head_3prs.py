"""The assembled 3-PRS head: the paper's bookkeeping, symmetry, smoothness along the stroke, and its spherical joint."""

import numpy as np
import pytest

import prs_model as prs

# Table 3 of the paper, semi-analytical column [Hz]
TABLE_3 = np.array([57.84, 59.56, 142.99, 155.84, 215.65, 226.93, 238.68, 274.22])


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs")


def test_bookkeeping_of_the_paper(head: prs.Machine) -> None:
    """25 condensation nodes of six coordinates and 11 components of three modes (section 3.3)."""
    index = head.assemble().index
    modal = [row for row in index if row.dof.startswith("mode")]
    nodes = {(row.body, row.node) for row in index if not row.dof.startswith("mode")}
    assert (len(index), len(nodes), len(modal)) == (183, 25, 33)


def test_rigid_seats_are_eliminated_exactly(head: prs.Machine) -> None:
    """165 coordinates remain, and the frequencies are the limit of ever stiffer seats, from below."""
    rigid = head.replace({"joints.seat": dict(per="limb", frame="board_<limb>", between=SEAT, rigid=True)}).assemble()
    assert rigid.size == 165
    limit = rigid.modes(8).frequencies
    errors = []
    for factor in (1e1, 1e2, 1e3):
        axes = head.description.joints["seat_1"].stiffness
        stiff = {axis: getattr(axes, axis) * factor / unit for axis, unit in SEAT_UNITS.items()}
        changed = head.replace({"joints.seat.stiffness": stiff}).modes(8).frequencies
        assert np.all(changed < limit)
        errors.append(np.max(limit / changed - 1.0))
    assert errors[1] / errors[0] == pytest.approx(0.1, rel=0.1)
    assert errors[2] / errors[1] == pytest.approx(0.1, rel=0.1)


SEAT = ("base.seat_<limb>", "board_<limb>.seat")
SEAT_UNITS = {"ux": 1e3, "uy": 1e3, "uz": 1e3, "rx": 1e-3, "ry": 1e-3, "rz": 1e-3}  # N/mm and N mm in SI


def test_first_eight_frequencies_are_a_fair_reconstruction(head: prs.Machine) -> None:
    np.testing.assert_allclose(head.modes(8).frequencies, TABLE_3, rtol=0.15)


@pytest.mark.parametrize("pose", [(0.0, 0.0), (0.2, 0.3), (0.5, 1.9)])
def test_identical_limbs_make_a_threefold_symmetry(head: prs.Machine, pose: tuple[float, float]) -> None:
    nutation, precession = pose
    turned = [head.modes(8, nutation=nutation, precession=precession + k * 2 * np.pi / 3).frequencies for k in range(3)]
    np.testing.assert_allclose(turned[1], turned[0], rtol=1e-5)
    np.testing.assert_allclose(turned[2], turned[0], rtol=1e-5)


def test_nothing_jumps_along_the_stroke(head: prs.Machine) -> None:
    """10 mm in steps of 0.5 mm: a contact that picked facets anew would jump by 1-2 %."""
    z = 1.270 + 0.0005 * np.arange(21)
    frequencies = np.array([head.modes(8, z=height).frequencies for height in z])
    second = np.diff(frequencies, 2, axis=0) / frequencies.mean(axis=0)
    assert np.max(np.abs(second)) < 2e-6
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
