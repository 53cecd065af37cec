"""Damping as it is described and as it is given in a call."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.response.damping import damping_of, modal_ratios
from tests.response.two_masses import K1, K2, M1, M2, matrices, row

JOINTS = "joints: {wall: {viscous: 2.0e-3}, spring: {viscous: 1.0e-3, loss_factor: 0.04}}"


def test_modal_ratios_are_those_of_the_modes(tmp_path: Path) -> None:
    modes = row(tmp_path, "modal: [0.02, 0.05]").modes(2)
    diagonal = modes.shapes.T @ modes.system.damping @ modes.shapes
    assert diagonal == pytest.approx(np.diag(2.0 * np.array([0.02, 0.05]) * 2.0 * np.pi * modes.frequencies))


def test_further_modes_have_the_last_ratio(tmp_path: Path) -> None:
    system = row(tmp_path, "modal: [0.03]").assemble()
    assert system.complex_modes(2).damping_ratios == pytest.approx([0.03, 0.03])
    for given in ([0.01, 0.02], np.array([0.01, 0.02]), {"modal": [0.01, 0.02]}, {"modal": np.array([0.01, 0.02])}):
        assert system.complex_modes(2, given).damping_ratios == pytest.approx([0.01, 0.02])


def test_rigid_body_modes_have_no_ratio(tmp_path: Path) -> None:
    """A free row of points: three rigid-body modes, exactly at zero, and one that has the first ratio of a list."""
    modes = row(tmp_path, ground=False).modes(7)
    assert modes.eigenvalues[:3].tolist() == [0.0, 0.0, 0.0]
    assert modes.eigenvalues[3] == pytest.approx(K2 * (1.0 / M1 + 1.0 / M2))
    for given in ([0.02, 0.05], {"rayleigh": {"alpha": 0.0, "beta": 0.04 / np.sqrt(modes.eigenvalues[3])}}):
        ratios = modal_ratios(damping_of(modes.system, given), modes.eigenvalues)
        assert np.isnan(ratios[:3]).all()
        assert ratios[3] == pytest.approx(0.02)
        assert modes.system.complex_modes(1, given).damping_ratios == pytest.approx([0.02])


def test_joints_damp_by_their_own_stiffness(tmp_path: Path) -> None:
    system = row(tmp_path, JOINTS).assemble()
    expected = matrices(2.0e-3 * K1, 1.0e-3 * K2)[1]
    sizes = np.linalg.eigvalsh(system.damping)
    assert sizes == pytest.approx(np.linalg.eigvalsh(expected))
    assert np.linalg.eigvalsh(system.loss_stiffness) == pytest.approx(np.linalg.eigvalsh(matrices(0, 0.04 * K2)[1]))


def test_joints_add_to_rayleigh(tmp_path: Path) -> None:
    """All joints with one time constant are Rayleigh's beta, as the bodies are rigid."""
    system = row(
        tmp_path, "rayleigh: {alpha: 2.0, beta: 1.0e-4}, joints: {wall: {viscous: 3e-4}, spring: {viscous: 3e-4}}"
    )
    damping = system.assemble().damping
    assert damping == pytest.approx(2.0 * system.assemble().mass + 4.0e-4 * system.assemble().stiffness)


def test_an_instance_may_damp_otherwise_than_its_kind() -> None:
    machine = prs.load_machine("hexapod")
    alike = machine.replace({"damping": {"joints": {"P": {"viscous": 1e-5}}}}).assemble()
    assert alike.damping == pytest.approx(1e-5 * alike.stiffness)
    one = machine.replace({"damping": {"joints": {"P": {"viscous": 1e-5}, "P_3": {"viscous": 0}}}}).assemble()
    assert np.linalg.matrix_rank(one.damping) == 5
    split = machine.replace({"joints.P_3.stiffness_factor": 1.0, "damping": {"joints": {"P": {"viscous": 1e-5}}}})
    assert split.assemble().damping == pytest.approx(alike.damping)


@pytest.mark.parametrize(
    ("damping", "words"),
    [
        (1.5, "damping.modal: found 1.5, expected a ratio below 1"),
        (-0.1, "found -0.1, expected zero or more"),
        ([0.02, 2.5], r"damping.modal\[1\]: found 2.5, expected a ratio below 1"),
        ([], "at least 1"),
        (float("nan"), "found nan"),
        ("much", "expected a ratio such as 0.025"),
        ([0.01, [0.02]], r"found \[0.01, \[0.02\]\], expected a ratio such as 0.025"),
        (0.01j, "found 0.01j, expected a ratio"),
        ({"modal": [0.01, 3]}, r"^damping.modal\[1\]: found 3, expected a ratio below 1, such as 0.025$"),
        ({"modal": 0.1, "rayleigh": {"alpha": 1.0, "beta": 0.0}}, "keep one"),
        ({"joints": {"sprin": {"viscous": 1e-4}}}, "unknown joint in damping 'sprin'; known: wall, spring"),
        ({"joints": {"spring": {"viscous": -1e-4}}}, "damping.joints.spring.viscous: found -0.0001"),
        ({"joints": {"spring": {"loss_factor": 3.0}}}, "expected a ratio below 2"),
        ({"mode": 0.1}, "did you mean 'modal'"),
    ],
)
def test_wrong_damping_is_told(tmp_path: Path, damping: object, words: str) -> None:
    modes = row(tmp_path).modes(2)
    with pytest.raises(prs.PrsError, match=words):
        modes.frf([10.0], damping)


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("joints: {sprin: {viscous: 1.0e-4}}", "found 'sprin', expected a joint .*; did you mean 'spring'"),
        ("joints: {spring: {}}", "expected 'viscous' .* or 'loss_factor'"),
        ("modal: [0.02, 2]", r"damping.modal\[1\]: found 2, expected a ratio below 1"),
        ("modal: some", "damping.modal: found 'some', expected a number"),
    ],
)
def test_a_wrong_section_is_told_with_its_line(tmp_path: Path, section: str, words: str) -> None:
    with pytest.raises(prs.DescriptionError, match=rf"machine.yaml:\d+: .*{words}"):
        row(tmp_path, section)
