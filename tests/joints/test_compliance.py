"""The joint algebra against direct stiffness algebra, limits, and the paper's printed form."""

import numpy as np
import pinocchio as pin
import pytest

from prs_model.description.schema import BallScrew, ElasticLaw
from prs_model.errors import PrsError
from prs_model.joints import (
    JointCompliance,
    along_axes,
    ball_screw_compliance,
    from_stiffness_matrix,
    parallel,
    series,
    series_as_printed,
)
from prs_model.joints.springs import elastic_law

BEARING = {0: 1e-9, 1: 1.2e-9, 2: 2e-9, 3: 3e-7, 4: 4e-7}  # free about z


def action(seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    rotation = pin.exp3(generator.normal(size=3))
    return np.asarray(pin.SE3(rotation, 0.1 * generator.normal(size=3)).toActionMatrix())


def stiffness_of(compliances: dict[int, float]) -> np.ndarray:
    stiffness = np.zeros((6, 6))
    for axis, compliance in compliances.items():
        stiffness[axis, axis] = 1.0 / compliance
    return stiffness


def test_moving_a_joint_is_the_tensor_transformation() -> None:
    """Eq. (13) in its sound form: K' = X^-T K X^-1, rank 5, null vector the moved free twist."""
    x = action(1)
    inverse = np.linalg.inv(x)
    moved = along_axes(BEARING).moved(x)
    expected = inverse.T @ stiffness_of(BEARING) @ inverse
    np.testing.assert_allclose(moved.stiffness, expected, rtol=1e-10, atol=1e-10 * abs(expected).max())
    assert np.linalg.matrix_rank(moved.wrenches) == 5
    np.testing.assert_allclose(moved.stiffness @ x[:, 5], 0.0, atol=1e-9 * abs(expected).max())


def test_interfaces_in_parallel_add_stiffness() -> None:
    """Eq. (11): the 6x6 sum with zero rows on the free axis."""
    actions = [np.asarray(pin.SE3(np.eye(3), np.array([0, 0, z])).toActionMatrix()) for z in (0.05, -0.05)]
    joint = parallel([along_axes(BEARING).moved(x) for x in actions])
    expected = sum(np.linalg.inv(x).T @ stiffness_of(BEARING) @ np.linalg.inv(x) for x in actions)
    np.testing.assert_allclose(joint.stiffness, expected, rtol=1e-10, atol=1e-10 * abs(expected).max())


def test_a_rigid_interface_rules_an_elastic_one_beside_it() -> None:
    rigid_in_x = along_axes({0: 0.0, 1: 1e-9, 2: 1e-9})
    joint = parallel([rigid_in_x, along_axes({0: 1e-8, 1: 1e-9, 2: 1e-9})])
    np.testing.assert_allclose(np.diag(joint.stiffness)[1:3], 2e9, rtol=1e-10)
    assert joint.rigid_wrenches.shape == (6, 1)
    np.testing.assert_allclose(
        np.abs(joint.rigid_wrenches[:, 0]) / np.abs(joint.rigid_wrenches).max(), np.eye(6)[0], atol=1e-9
    )


def test_three_bearings_in_series_make_a_translational_spring() -> None:
    """The sound spherical joint: rank 3, no resistance to any rotation about its centre."""
    turns = [np.eye(3), pin.exp3(np.array([np.pi / 2, 0, 0])), pin.exp3(np.array([0, np.pi / 2, 0]))]
    actions = [np.asarray(pin.SE3(turn, np.zeros(3)).toActionMatrix()) for turn in turns]
    stiffness = series([along_axes(BEARING)] * 3, actions).stiffness
    assert np.linalg.matrix_rank(stiffness, tol=1e-6 * abs(stiffness).max()) == 3
    np.testing.assert_allclose(stiffness[3:], 0.0, atol=1e-6)
    compliance = sum(turn @ np.diag([1e-9, 1.2e-9, 2e-9]) @ turn.T for turn in turns)
    np.testing.assert_allclose(stiffness[:3, :3], np.linalg.inv(compliance), rtol=1e-9, atol=1.0)


def test_the_printed_spherical_joint_resists_rotation() -> None:
    """Eq. (14) to the letter: each free axis has zero compliance, the other bearings' tilt resists."""
    turns = [np.eye(3), pin.exp3(np.array([np.pi / 2, 0, 0])), pin.exp3(np.array([0, np.pi / 2, 0]))]
    actions = [np.asarray(pin.SE3(turn, np.zeros(3)).toActionMatrix()) for turn in turns]
    printed = series_as_printed([along_axes(BEARING)] * 3, actions).stiffness
    padded = np.diag([1e-9, 1.2e-9, 2e-9, 3e-7, 4e-7, 0.0])
    np.testing.assert_allclose(printed, np.linalg.inv(sum(x @ padded @ x.T for x in actions)), rtol=1e-9, atol=1e-3)
    assert np.linalg.matrix_rank(printed) == 6


def hinges_at(angles: np.ndarray) -> tuple[list[JointCompliance], list[np.ndarray]]:
    """Two hinges about axes of one plane, the second turned by each of the angles [rad] against the first."""
    across, elastic = pin.exp3(np.array([0, np.pi / 2, 0])), along_axes(BEARING)
    turned = [pin.SE3(pin.exp3(np.array([0, angle, 0])), np.zeros(3)).toActionMatrix() for angle in angles]
    lying = np.asarray(pin.SE3(across, np.zeros(3)).toActionMatrix())
    return [elastic, along_axes({**BEARING, 0: 0.0})], [lying, np.array(turned)]


def test_many_chains_at_once_are_the_same_as_one_by_one() -> None:
    angles = np.array([0.0, 0.3, np.pi / 2 - 1e-5])
    joints, (first, turned) = hinges_at(angles)
    together = series(joints, [first, turned])
    assert together.stiffness.shape == (3, 6, 6)
    for i, each in enumerate(turned):
        alone = series(joints, [first, each])
        assert together.stiffness[i] == pytest.approx(alone.stiffness, rel=1e-12, abs=1e-12 * alone.stiffness.max())
        assert together.wrenches[i] == pytest.approx(alone.wrenches, abs=1e-12)
        assert np.abs(together.wrenches[i].T @ np.column_stack([first[:, 5], each[:, 5]])).max() < 1e-14


def test_chains_of_which_one_is_freer_are_not_made_together() -> None:
    """With both axes in one line a direction is free that is held elsewhere."""
    joints, actions = hinges_at(np.array([0.3, np.pi / 2]))
    with pytest.raises(PrsError, match=r"different numbers of directions free or rigid \(1 and 2\)"):
        series(joints, actions)


def test_series_of_two_springs_halves_the_stiffness() -> None:
    matrix = from_stiffness_matrix(stiffness_of(dict.fromkeys(range(6), 1e-8)))
    np.testing.assert_allclose(series([matrix, matrix], [np.eye(6)] * 2).stiffness, 0.5e8 * np.eye(6), atol=1e-3)


def test_stiffness_matrix_keeps_its_null_space_free() -> None:
    x = np.linalg.inv(action(3))
    stiffness = x.T @ stiffness_of(BEARING) @ x
    joint = from_stiffness_matrix(0.5 * (stiffness + stiffness.T))
    assert joint.wrenches.shape == (6, 5)
    np.testing.assert_allclose(joint.stiffness, stiffness, rtol=1e-8, atol=1e-9 * abs(stiffness).max())


def test_ball_screw_is_softest_between_its_bearings() -> None:
    """Footnote of Table 2: the two halves of the screw act in parallel, the nut in series with them."""
    screw = BallScrew.model_validate(
        dict(kind="ball_screw", nut=1e9, front_bearing=1.25e9, rear_bearing=1.25e9, EA=3e8, length=1.0, origin=0.0)
    )
    expected = 1 / 1e9 + 1 / (1 / (1 / 1.25e9 + 0.5 / 3e8) * 2)
    assert ball_screw_compliance(screw, 0.5) == pytest.approx(expected, rel=1e-12)
    assert ball_screw_compliance(screw, 0.5) > ball_screw_compliance(screw, 0.1)
    assert ball_screw_compliance(screw, 0.3) == pytest.approx(ball_screw_compliance(screw, 0.7), rel=1e-12)
    assert ball_screw_compliance(screw, -1e-15) == ball_screw_compliance(screw, 0.0)
    with pytest.raises(PrsError, match="from the front bearing"):
        ball_screw_compliance(screw, 1.2)


def test_a_screw_with_a_floating_end_softens_towards_it() -> None:
    """1/k = 1/k_nut + 1/k_front + q/EA; a rear bearing of almost no stiffness comes to the same."""
    floating = dict(kind="ball_screw", nut=1e9, front_bearing=1.25e9, EA=3e8, length=1.0, origin=0.0)
    screw = BallScrew.model_validate(floating)
    loose = BallScrew.model_validate({**floating, "rear_bearing": 1e-3})
    for stroke in (0.0, 0.4, 1.0):
        expected = 1 / 1e9 + 1 / 1.25e9 + stroke / 3e8
        assert ball_screw_compliance(screw, stroke) == pytest.approx(expected, rel=1e-12)
        assert ball_screw_compliance(loose, stroke) == pytest.approx(expected, rel=1e-9)


def test_a_floating_bearing_transmits_nothing_along_its_zero() -> None:
    """Zero stiffness is no direction at all: rank 4 beside the free axis, no tiny number in its place."""
    law = ElasticLaw.model_validate(dict(stiffness=dict(ux=1e9, uy=1e9, uz=0.0, rx=1e6, ry="rigid")))
    joint = elastic_law(law, 5)
    assert joint.wrenches.shape == (6, 4)
    np.testing.assert_allclose(np.diag(joint.stiffness), [1e9, 1e9, 0, 1e6, 0, 0], rtol=1e-12)
    np.testing.assert_allclose(np.abs(joint.rigid_wrenches[:, 0]), np.eye(6)[4])
