"""The 3-PRS head: closed form, batched Newton and Newton on Pinocchio's constraints are three independent ways."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model import UnreachablePoseError
from prs_model.kinematics import Kinematics

A, B, ROD, TOOL = 0.330, 0.165, 0.350, 0.315  # Table 1 of the paper


def poses(rng: np.random.Generator, count: int, nutation_deg: float = 40.0) -> np.ndarray:
    low, high = [0.0, 0.0, 1.175], [np.radians(nutation_deg), 2 * np.pi, 1.375]
    return rng.uniform(low, high, (count, 3))


def slides(head: Kinematics, q: np.ndarray) -> np.ndarray:
    return q[..., [head.tree.joint(f"slide_{limb}") for limb in (1, 2, 3)]]


def test_closed_form_and_batched_newton_agree_and_close_the_loops(head: Kinematics, rng: np.random.Generator) -> None:
    some = poses(rng, 10_000)
    closed, newton = head.solve_batch(some), head.newton_batch(some)
    assert closed.closure_residual.max() < 1e-10
    assert newton.closure_residual.max() < 1e-10
    assert np.abs(closed.q - newton.q).max() < 1e-9
    assert np.abs(closed.placements("tool") - newton.placements("tool")).max() < 1e-9


def test_pinocchio_agrees_pose_by_pose(head: Kinematics, rng: np.random.Generator) -> None:
    some = poses(rng, 40, nutation_deg=30.0)
    batch = head.solve_batch(some)
    for i, pose in enumerate(some):
        twin = head.newton(dict(zip(head.pose_names, pose, strict=True)))
        assert np.abs(twin.q - batch.q[i]).max() < 1e-9
        assert np.abs(twin.placement("rod_3").homogeneous - batch.placements("rod_3")[i]).max() < 1e-9


def test_tool_stands_where_the_pose_says(head: Kinematics) -> None:
    nutation, precession, z = 0.4, 2.0, 1.25
    tool = head.solve({"nutation": nutation, "precession": precession, "z": z}).placement("tool")
    axis = [np.sin(nutation) * np.cos(precession), np.sin(nutation) * np.sin(precession), np.cos(nutation)]
    np.testing.assert_allclose(tool.rotation[:, 2], axis, atol=1e-12)
    assert tool.rotation[1, 0] == pytest.approx(tool.rotation[0, 1], abs=1e-12)  # no torsion
    assert tool.translation[2] == pytest.approx(z, abs=1e-12)


def test_sliders_where_one_rod_stands_in_the_plane_of_tilt(head: Kinematics) -> None:
    """Tilt about the R axis of limb 1: its S centre shifts inwards by b (1 - cos theta) 3 / 2; 651.333 mm at rest."""
    theta, z = np.radians([0.0, 10.0, 30.0]), np.array([1.275, 1.2, 1.375])
    batch = head.solve_batch(np.column_stack([theta, np.full(3, np.pi / 2), z]))
    radial = A - B * np.cos(theta) + B / 2 * (1 - np.cos(theta))
    expected = z - TOOL * np.cos(theta) + B * np.sin(theta) - np.sqrt(ROD**2 - radial**2)
    np.testing.assert_allclose(slides(head, batch.q)[:, 0], expected, atol=1e-12)
    assert expected[0] == pytest.approx(0.651333, abs=1e-6)


def test_the_workspace_is_within_the_joint_limits(head: Kinematics) -> None:
    grids = [np.linspace(low, high, 25) for low, high in head.description.workspace.values()]
    batch = head.solve_batch(np.stack(np.meshgrid(*grids, indexing="ij"), axis=-1).reshape(-1, 3))
    assert batch.reachable.all()


def test_turning_by_120_degrees_exchanges_the_limbs(head: Kinematics, rng: np.random.Generator) -> None:
    some = poses(rng, 50)
    turned = slides(head, head.solve_batch(some + np.array([0.0, 2 * np.pi / 3, 0.0])).q)
    np.testing.assert_allclose(np.roll(slides(head, head.solve_batch(some).q), 1, axis=1), turned, atol=1e-12)


def test_precession_means_nothing_without_nutation(head: Kinematics) -> None:
    straight = head.newton_batch(np.array([[0.0, psi, 1.3] for psi in (0.0, 1.0, 4.0)]))
    np.testing.assert_allclose(straight.q, straight.q[[0, 0, 0]], atol=1e-12)


@pytest.mark.parametrize("turns", [-1, 1, 3])
def test_full_turns_of_nutation_are_the_same_pose(head: Kinematics, turns: int) -> None:
    pose = np.array([[0.3, 1.0, 1.275]])
    turned = pose + np.array([2 * np.pi * turns, 0.0, 0.0])
    for solve in (head.solve_batch, head.newton_batch):
        np.testing.assert_allclose(solve(turned).q, solve(pose).q, atol=1e-12)


def test_one_bad_pose_leaves_the_others_of_a_batch_alone(head: Kinematics) -> None:
    """Upside down, the sense of the rotation vector is a matter of rounding: no configuration, but no error either."""
    batch = head.solve_batch(np.array([[0.0, 0.0, 1.275], [np.pi, 0.3, 1.275], [1e6, 0.0, -1e6], [0.1, 0.0, 1.3]]))
    assert batch.reachable.tolist() == [True, False, False, True]
    assert np.isfinite(batch.q[[0, 3]]).all()


def test_a_closed_form_that_fails_at_one_pose_marks_it(head: Kinematics, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = type(head.task).closed_form
    off = np.array([[0.0], [1e-6]])
    monkeypatch.setattr(type(head.task), "closed_form", lambda task, poses: exact(task, poses) + off[: len(poses)])
    batch = head.solve_batch(np.array([[0.0, 0.0, 1.275], [0.1, 0.0, 1.3]]))
    assert batch.reachable.tolist() == [True, False]
    assert "closed form does not hold there: it leaves a gap of " in batch.reasons[1]
    assert np.isnan(batch.q[1]).all()


def test_beyond_a_joint_limit(head: Kinematics) -> None:
    pose = {"nutation": np.radians(70), "precession": 0.2, "z": 1.275}
    with pytest.raises(UnreachablePoseError) as caught:
        head.solve(pose)
    error = caught.value
    assert error.pose == pose
    assert error.joint == "slide_3"
    assert error.value == pytest.approx(1.022, abs=1e-3)
    assert error.limits == (0.5, 0.9)
    assert str(error) == (
        "pose nutation 70 deg, precession 11.459 deg, z 1275 mm: joint slide_3 (limb 3) would stand at 1021.994 mm, "
        "limits 500 .. 900 mm"
    )


def test_rod_too_short(head: Kinematics) -> None:
    pose = {"nutation": np.radians(89), "precession": 0.2, "z": 1.275}
    with pytest.raises(UnreachablePoseError, match="limb 2 cannot reach it: no value of slide_2, hinge_2"):
        head.solve(pose)
    with pytest.raises(UnreachablePoseError, match=r"only up to 9\d.\d % of the way .* slide_3 \(limb 3\) stands at"):
        head.newton(pose)


def test_batches_mark_what_is_out_of_reach(head: Kinematics) -> None:
    degrees = np.radians([[10, 0], [70, 10], [89, 10]])
    some = np.column_stack([degrees, np.full(3, 1.275)])
    for batch in (head.solve_batch(some), head.newton_batch(some)):
        assert batch.reachable.tolist() == [True, False, False]
        assert [bool(reason) for reason in batch.reasons] == [False, True, True]
        assert np.isfinite(batch.q).all(axis=1).tolist() == [True, True, False]
        assert batch[0].joint_values["slide_1"] == pytest.approx(batch.q[0, 0])
        with pytest.raises(UnreachablePoseError, match="slide_3"):
            batch[1]
