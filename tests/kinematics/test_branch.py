"""Solutions on another assembly branch are found out and replaced."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from prs_model import UnreachablePoseError
from prs_model.kinematics import Kinematics
from prs_model.kinematics.newton import newton

from .mechanisms import crank_angles, planar_3rrr

POSE = np.array([[0.3, 1.0, 1.275]])


@pytest.mark.parametrize("limbs", [(1,), (2, 3), (1, 2, 3)])
def test_rods_that_point_backwards(head: Kinematics, limbs: tuple[int, ...]) -> None:
    """An even number of them leaves the sign of the determinant as it was."""
    targets, right = head.task.targets(POSE), head.solve_batch(POSE).q
    flipped = right.copy()
    for limb in limbs:
        slide, hinge = head.tree.joint(f"slide_{limb}"), head.tree.joint(f"hinge_{limb}")
        flipped[0, slide] += 2 * 0.350 * np.cos(right[0, hinge])
        flipped[0, hinge] = -np.pi - right[0, hinge]
    wrong, solved = newton(head.equations, flipped, targets, iterations=30)
    assert solved.all()
    assert np.abs(wrong - right).max() > 0.5
    settled, share = head.branch.settle(wrong, solved, targets)
    assert share[0] == 1.0
    np.testing.assert_allclose(settled, right, atol=1e-9)


def test_from_anywhere_to_the_reference_branch(head: Kinematics, rng: np.random.Generator) -> None:
    poses = rng.uniform([0.0, 0.0, 1.175], [0.7, 6.28, 1.375], (500, 3))
    targets, right = head.task.targets(poses), head.solve_batch(poses).q
    start = head.branch.q + rng.uniform(-1.0, 1.0, right.shape)
    wild, solved = newton(head.equations, start, targets, iterations=30)
    assert (np.abs(wild - right).max(axis=1)[solved] > 1e-6).sum() > 20  # Newton alone goes astray
    settled, share = head.branch.settle(wild, solved, targets)
    assert share.min() == 1.0
    assert np.abs(settled - right).max() < 1e-9


def test_large_turns_are_followed(tmp_path: Path) -> None:
    """The plate of the 3-RRR turns all the way round; its last joints turn with it."""
    planar = planar_3rrr(tmp_path)
    poses = np.radians([[0.0, 0.0, angle] for angle in (-170.0, -60.0, 60.0, 170.0)])
    batch = planar.solve_batch(poses)
    assert batch.reachable.all()
    np.testing.assert_allclose(batch.q[:, planar.tree.joint("a_2")], crank_angles(poses), atol=1e-9)


def test_where_the_way_ends(tmp_path: Path) -> None:
    """Leg 1 reaches 0.7 m: from its anchor at y = -0.5 the plate, 0.15 m wide, gets to y = 0.35."""
    planar = planar_3rrr(tmp_path)
    with pytest.raises(UnreachablePoseError, match=r"only up to (49|50).. % of the way from the reference"):
        planar.solve({"x": 0.0, "y": 0.7, "phi": 0.0})
