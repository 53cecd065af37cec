"""The frame of the low shapes: exact eigenvalues, and no trace of the basis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.interpolated.frames import Frame, in_frame
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
    frame = Frame(modes.shapes[0][:, :5], shift)
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
    frame = Frame(modes.shapes[0][:, :4], 0.0)
    assert in_frame(frame, systems, others).alignment[0] < 1e-9


def test_the_frame_does_not_depend_on_the_basis_within_a_pair() -> None:
    """The first two modes of the hexapod in the middle have one frequency: any two directions span them."""
    systems, modes = solved(prs.load_machine("hexapod"), np.array([[0.0, 0.0, 0.09, 0.0, 0.0, 0.0]]))
    assert modes.eigenvalues[0, 1] == pytest.approx(modes.eigenvalues[0, 0], rel=1e-9)
    home = np.linalg.qr(np.random.default_rng(6).normal(size=(4, 4)))[0]
    frame = Frame(modes.shapes[0][:, :4] @ home, 0.0)
    turn = np.eye(modes.shapes.shape[2])
    turn[:2, :2] = [[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]]
    turned = replace(modes, shapes=modes.shapes @ (turn * [1, 1, -1, 1, -1, 1]))
    one, other = in_frame(frame, systems, modes), in_frame(frame, systems, turned)
    np.testing.assert_allclose(other.logarithms, one.logarithms, atol=1e-9)
    np.testing.assert_allclose(other.frames, one.frames, atol=1e-9)
