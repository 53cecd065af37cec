"""Modes of equal frequency: the shapes that stand for them are always the same, and say which way the tool goes."""

from dataclasses import replace

import numpy as np
import pytest

import prs_model as prs
from prs_model.modes.clusters import parted_shapes, principal_shapes


@pytest.mark.parametrize("name", ["hexapod", "head_3prs"])
def test_of_a_pair_the_first_moves_the_tool_along_u(name: str) -> None:
    modes = prs.load_machine(name).modes(8)
    pairs = [k for k in range(len(modes.frequencies) - 1) if np.diff(modes.frequencies)[k] < 1e-4]
    assert len(pairs) >= 2
    for k in pairs:
        u, v = modes.output_shapes[:2, k : k + 2]
        assert u[0] > 0.0
        assert v[1] > 0.0
        assert u[1] == pytest.approx(0.0, abs=1e-9 * u[0])


@pytest.mark.parametrize("name", ["hexapod", "head_3prs"])
def test_however_they_come_they_leave_the_same(name: str) -> None:
    modes = prs.load_machine(name).modes(8)
    shapes, (c, s) = modes.shapes.copy(), (np.cos(0.7), np.sin(0.7))
    shapes[:, :2] = shapes[:, :2] @ [[c, -s], [s, c]]
    again = replace(modes, shapes=principal_shapes(modes.system, modes.frequencies, shapes))
    for name, share in again.strain_energy().items():
        assert share == pytest.approx(modes.strain_energy()[name], abs=1e-9)
    assert not np.allclose(replace(modes, shapes=shapes).modal_flexibility()[:2], modes.modal_flexibility()[:2])
    assert again.modal_flexibility() == pytest.approx(modes.modal_flexibility())


def test_a_pair_is_not_cut_in_two() -> None:
    """One mode of a pair is the same as the first of both."""
    machine = prs.load_machine("hexapod")
    assert machine.modes(1).output_shapes[:, 0] == pytest.approx(machine.modes(6).output_shapes[:, 0], abs=1e-9)


def test_rigid_motions_are_axes_too() -> None:
    """Struts without stiffness let a platform float: the first mode has all that moves along u, the next along v, .."""
    system = prs.load_machine("hexapod").assemble()
    modes = replace(system, stiffness=np.zeros_like(system.stiffness)).modes(6)
    assert modes.frequencies.tolist() == [0.0] * 6
    along = modes.output_shapes[:3]
    assert np.all(np.diag(along) > 0.0)
    assert np.triu(along, 1) == pytest.approx(np.zeros((3, 6)), abs=1e-9)


def test_parted_again_they_do_without_each_other() -> None:
    """Limbs meshed not quite alike part the head's pairs by some 1e-8, which the response at a peak tells apart."""
    system = prs.load_machine("head_3prs").assemble()
    modes = system.modes(20)
    shapes = parted_shapes(system.stiffness, modes.frequencies, modes.shapes)
    coupling = shapes.T @ system.stiffness @ shapes - np.diag(modes.eigenvalues)
    assert np.abs(coupling).max() < 1e-11 * modes.eigenvalues[-1]
