"""The frame of the low shapes: exact eigenvalues, no trace of the basis, and an exact count below a level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh, null_space

import prs_model as prs
from prs_model.sweep.frames import Frame, in_frame
from prs_model.sweep.low_modes import LowModes, low_modes
from prs_model.synthesis import Systems, assemble_many
from tests.verification.gantry import TRAVEL, gantry


def solved(machine: prs.Machine, poses: np.ndarray) -> tuple[Systems, LowModes]:
    configurations = machine.kinematics.solve_batch(poses)
    systems = assemble_many(machine.description, machine.parts, machine.joints, configurations)
    return systems, low_modes(systems, 12, 0.0)


@pytest.fixture(scope="module")
def at_poses(tmp_path_factory: pytest.TempPathFactory) -> tuple[Systems, LowModes]:
    """A gantry whose contact travels; the first pose is home."""
    machine = gantry(tmp_path_factory.mktemp("gantry"), travel=TRAVEL)
    return solved(machine, np.array([[0.37, 0.02, 0.0], [0.35, 0.05, 0.2], [0.41, -0.01, -0.3]]))


@pytest.mark.parametrize("shift", [0.0, -1e6])
def test_eigenvalues_in_the_frame_are_the_exact_ones(at_poses: tuple[Systems, LowModes], shift: float) -> None:
    systems, modes = at_poses
    frame = Frame(modes.shapes[0][:, :5], shift, None)
    found = in_frame(frame, systems, modes)
    values = np.exp(np.linalg.eigvalsh(found.logarithms)) + shift
    np.testing.assert_allclose(values, modes.eigenvalues[:, :5], rtol=1e-11)
    np.testing.assert_allclose(found.logarithms[0], np.diag(np.diag(found.logarithms[0])), atol=1e-9)
    gram = found.frames.swapaxes(1, 2) @ systems.mass @ found.frames
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(5), gram.shape), atol=1e-10)
    assert found.alignment[0] == pytest.approx(1.0)
    assert (found.alignment[1:] < 1.0 - 1e-6).all()
    assert (found.alignment > 0.0).all()


def test_a_shape_that_is_lost_shows_in_the_alignment(at_poses: tuple[Systems, LowModes]) -> None:
    systems, modes = at_poses
    others = LowModes(modes.eigenvalues[:, 1:], modes.shapes[:, :, 1:])
    frame = Frame(modes.shapes[0][:, :4], 0.0, None)
    assert in_frame(frame, systems, others).alignment[0] < 1e-9


def test_the_frame_does_not_depend_on_the_basis_within_a_pair() -> None:
    """The first two modes of the hexapod in the middle have one frequency: any two directions span them."""
    systems, modes = solved(prs.load_machine("hexapod"), np.array([[0.0, 0.0, 0.09, 0.0, 0.0, 0.0]]))
    assert modes.eigenvalues[0, 1] == pytest.approx(modes.eigenvalues[0, 0], rel=1e-9)
    home = np.linalg.qr(np.random.default_rng(6).normal(size=(4, 4)))[0]
    frame = Frame(modes.shapes[0][:, :4] @ home, 0.0, 0.5 * float(modes.eigenvalues[0, 3:5].sum()))
    turn = np.eye(modes.shapes.shape[2])
    turn[:2, :2] = [[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]]
    turned = replace(modes, shapes=modes.shapes @ (turn * [1, 1, -1, 1, -1, 1]))
    one, other = in_frame(frame, systems, modes), in_frame(frame, systems, turned)
    np.testing.assert_allclose(other.logarithms, one.logarithms, atol=1e-9)
    np.testing.assert_allclose(other.frames, one.frames, atol=1e-9)
    np.testing.assert_allclose(other.complements, one.complements, rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("p", [3, 5])
def test_negatives_of_the_complement_count_eigenvalues_below_any_level(
    at_poses: tuple[Systems, LowModes], p: int
) -> None:
    """Haynsworth: K - l M has those of Z and those of the rest, on shapes that are M-orthogonal to the frame's."""
    systems, modes = at_poses
    home = modes.shapes[0][:, :p]
    levels = np.sqrt(modes.eigenvalues[1, :-1] * modes.eigenvalues[1, 1:])
    exact = 0
    for level in [0.5 * modes.eigenvalues[1, 0], *levels[: p + 3]]:
        found = in_frame(Frame(home, 0.0, float(level)), systems, modes)
        assert found.complements is not None
        for i, (mass, stiffness, free) in enumerate(systems.pencils):
            below = int((eigh(stiffness, mass, eigvals_only=True) < level).sum())
            rest = null_space(home.T @ systems.mass[i] @ free)
            in_rest = np.linalg.eigvalsh(rest.T @ (stiffness - level * mass) @ rest)
            negatives = int((np.linalg.eigvalsh(found.complements[i]) < 0.0).sum())
            assert negatives + int((in_rest < 0.0).sum()) == below
            exact += negatives == below
    assert exact >= 3 * (p + 1)  # the rest is positive wherever the level is no higher than what the frame leaves out


def test_a_machine_held_by_rigid_joints_is_counted_on_what_can_move() -> None:
    poses = np.array([[0.0, 0.0, 0.09, 0.0, 0.0, 0.0], [0.002, -0.001, 0.091, 0.04, 0.01, 0.03]])
    systems, modes = solved(prs.load_machine("hexapod"), poses)
    level = float(np.sqrt(modes.eigenvalues[:, 2].max() * modes.eigenvalues[:, 3].min()))
    found = in_frame(Frame(modes.shapes[0][:, :3], 0.0, level), systems, modes)
    assert found.complements is not None
    assert ((np.linalg.eigvalsh(found.complements) < 0.0).sum(axis=1) == 3).all()
