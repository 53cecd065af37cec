"""What Newton's method does where there is no step to take."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model.kinematics import Kinematics
from prs_model.kinematics.newton import _least_squares, least_squares_of_one, newton


@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_no_step_from_numbers_that_are_none(number: float, capfd: pytest.CaptureFixture[str]) -> None:
    """LAPACK must not even be asked: it prints on standard output."""
    jacobian = np.eye(3)
    jacobian[1, 1] = number
    assert least_squares_of_one(jacobian, np.ones(3)) == pytest.approx(np.zeros(3))
    assert least_squares_of_one(np.eye(3), np.full(3, number)) == pytest.approx(np.zeros(3))
    assert capfd.readouterr().out == ""


def test_a_pose_without_numbers_is_not_solved_and_holds_up_no_other(head: Kinematics) -> None:
    targets = head.task.targets(np.array([[0.1, 0.0, 1.275], [0.2, 1.0, 1.3]]))
    start = np.stack([np.full(head.tree.size, np.nan), head.branch.q])
    q, solved = newton(head.equations, start, targets)
    assert solved.tolist() == [False, True]
    assert np.abs(q[1] - head.solve_batch(np.array([[0.2, 1.0, 1.3]])).q[0]).max() < 1e-9


def test_a_singular_jacobian_holds_up_no_other() -> None:
    steps = _least_squares(np.stack([np.diag([1.0, 0.0]), np.eye(2), np.full((2, 2), np.nan)]), np.ones((3, 2)))
    assert steps == pytest.approx(np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]))
