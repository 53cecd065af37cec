"""The lowest modes of many configurations are those the machine has in each of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.low_modes import low_modes
from prs_model.synthesis import Systems, assemble_many
from tests.sweep.stick import stick
from tests.verification.gantry import TRAVEL, gantry

COUNT = 8
HINGE = {"joints.R.stiffness": {"ux": "rigid", "uy": 9.0e8, "uz": "rigid", "rx": 9.0e5, "ry": 9.0e5}}


def machine_of(kind: str, folder: Path) -> prs.Machine:
    if kind == "held by rigid joints":
        return prs.load_machine("hexapod")
    if kind == "travelling contact":
        return gantry(folder, travel=TRAVEL).replace(HINGE)
    return stick(folder, held=kind == "massless node")


def at_some_poses(machine: prs.Machine, count: int) -> tuple[Systems, list[prs.Modes]]:
    low, high = np.array([machine.workspace[name] for name in machine.pose_names]).reshape(-1, 2).T
    poses = low + (high - low) * np.random.default_rng(3).random((count, len(low)))
    configurations = machine.kinematics.solve_batch(poses)
    systems = assemble_many(machine.description, machine.parts, machine.joints, configurations)
    return systems, [machine.assemble(configurations[i]).modes(COUNT) for i in range(count)]


@pytest.mark.parametrize("kind", ["held by rigid joints", "travelling contact", "massless node", "free"])
@pytest.mark.parametrize("shift", [0.0, -1e5])
def test_they_are_the_machines_modes(tmp_path: Path, kind: str, shift: float) -> None:
    """Whatever shift is given: where K - s M is not positive definite with it, another is taken."""
    systems, expected = at_some_poses(machine_of(kind, tmp_path), 3)
    found = low_modes(systems, COUNT, shift)
    for i, modes in enumerate(expected):
        scale = modes.eigenvalues[-1] if kind == "free" else modes.eigenvalues
        assert (np.abs(found.eigenvalues[i] - modes.eigenvalues) < 1e-9 * scale).all()
        shapes, mass, stiffness = found.shapes[i], systems.mass[i], systems.stiffness[i]
        np.testing.assert_allclose(shapes.T @ mass @ shapes, np.eye(shapes.shape[1]), atol=1e-9)
        energies = np.diag(shapes.T @ stiffness @ shapes)
        np.testing.assert_allclose(energies, found.eigenvalues[i], rtol=1e-7, atol=1e-9 * modes.eigenvalues[-1])
        assert np.abs(systems.constraints[i] @ shapes).max(initial=0.0) < 1e-9 * np.abs(shapes).max()


def test_a_machine_with_fewer_modes_than_asked_for_has_those(tmp_path: Path) -> None:
    systems, modes = at_some_poses(prs.load_machine("hexapod"), 2)
    assert low_modes(systems, 50, 0.0).eigenvalues.shape == (2, 6)
    assert len(modes[0].frequencies) == 6


def test_a_machine_that_is_free_has_six_modes_at_zero(tmp_path: Path) -> None:
    systems, _ = at_some_poses(stick(tmp_path, held=False), 1)
    values = low_modes(systems, COUNT, 0.0).eigenvalues[0]
    assert np.abs(values[:6]).max() < 1e-9 * values[6]
