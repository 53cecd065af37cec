"""Lists of poses swept in one basis, of machines that are hard on the dual form: every frequency within its bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.enclosed import kernels_ritz
from prs_model.sweep.enclosed.dual_packed import packed
from prs_model.sweep.quantities import BOUNDED, DENSE
from prs_model.synthesis import dual_assembly
from prs_model.synthesis.redundancy import without_redundant
from tests.sweep.nasty import nasty
from tests.sweep.stick import stick
from tests.synthesis.test_dual import knob

COUNT = 2000
ROW = (30.0, 40.0, 41.0, 55.0, 70.0, 300.0)
ROUNDING = 1e-9
"""Of the dense solver's frequencies, where joints are very stiff."""

GUIDE = """  guide2: {frame: base, between: [ground, plunger.end],
           stiffness: {ux: 0, uy: rigid, uz: rigid, rx: rigid, ry: rigid, rz: rigid}}
"""
LEAF = """  cap: {frame: base, reducer: rigid, options: {mass: 1, inertia: {xx: 1, yy: 1.3, zz: 1.7},
        nodes: {a: [0.1, 0.2, 0.3]}}, interfaces: {a: {}}}
  leaf:
    frame: base
    reducer: lumped
    options:
      nodes: {a: [0, 0, 0], b: [0.1, 0.2, 0.3]}
      masses: {}
      springs: [{between: [a, b], stiffness: {ux: 2.0e5, uy: 3.0e5, uz: 4.0e5, rx: 5.0e3, ry: 6.0e3, rz: 7.0e3}}]
    interfaces: {a: {}, b: {}}
"""
CLAMPS = """  foot: {frame: base, between: [ground, leaf.a],
         stiffness: {ux: rigid, uy: rigid, uz: rigid, rx: 1.0e6, ry: rigid, rz: rigid}}
  tip: {frame: base, between: [leaf.b, cap.a],
        stiffness: {ux: rigid, uy: rigid, uz: rigid, rx: 1.0e6, ry: rigid, rz: rigid}}
"""


def changed(folder: Path, bodies: str = "", joints: str = "") -> prs.Machine:
    """The machine made to mislead, with more bodies and joints."""
    nasty(folder, ROW, 4000.0)
    file = folder / "machine.yaml"
    text = file.read_text().replace("bodies:\n", f"bodies:\n{bodies}", 1).replace("output:", f"{joints}output:", 1)
    file.write_text(text)
    return prs.load_machine(folder)


@dataclass(frozen=True)
class Case:
    make: Callable[[Path], prs.Machine]
    n_modes: int


CASES = {
    "slow": Case(lambda folder: nasty(folder, (0.5, *ROW[1:]), 4000.0), 6),
    "slow and fast": Case(lambda folder: nasty(folder, ROW, 4000.0), 10),
    "rigid joints that repeat each other": Case(lambda folder: changed(folder, joints=GUIDE), 6),
    "a leaf without mass between joints": Case(lambda folder: changed(folder, LEAF, CLAMPS), 9),
    "coordinates that only joints hold": Case(knob, 6),
    "a place without mass": Case(lambda folder: stick(folder, held=True), 8),
}


def listed(machine: prs.Machine) -> np.ndarray:
    if not machine.pose_names:
        return np.zeros((COUNT, 0))
    return np.random.default_rng(0).uniform([0.0, 0.0, -3.0], [1.0, 1.0, 3.0], size=(COUNT, 3))


def exact_at(machine: prs.Machine, poses: np.ndarray, count: int) -> np.ndarray:
    found = machine.kinematics.solve_batch(poses)
    return np.array([machine.assemble(found[i]).modes(count).frequencies for i in range(len(poses))])


@pytest.mark.parametrize("name", CASES)
def test_frequencies_are_within_their_bounds(name: str, tmp_path: Path) -> None:
    machine, n = CASES[name].make(tmp_path), CASES[name].n_modes
    poses = listed(machine)
    swept = machine.sweep(poses=poses, n_modes=n)
    assert (swept["proof"].to_numpy() == BOUNDED).mean() > 0.95
    some = slice(None, None, 90 if machine.pose_names else COUNT)
    errors = swept["frequency"].to_numpy()[some] / exact_at(machine, poses[some], n) - 1.0
    assert (np.abs(errors) <= swept["bound"].to_numpy()[some] + ROUNDING).all()
    assert (errors[swept["proof"].to_numpy()[some] == BOUNDED] >= -ROUNDING).all()


def test_rigid_motions_are_left_to_the_dense_solver(tmp_path: Path) -> None:
    machine = stick(tmp_path, held=False)
    swept = machine.sweep(poses=np.zeros((COUNT, 0)), n_modes=8)
    assert (swept["proof"].to_numpy() == DENSE).all()
    np.testing.assert_allclose(swept["frequency"].to_numpy()[0], machine.modes(8).frequencies, rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("compiled", [False, True])
def test_counts_are_unsure_where_rigid_joints_repeat_each_other(compiled: bool, tmp_path: Path) -> None:
    kernels = kernels_ritz
    if compiled:
        pytest.importorskip("numba", reason="compiled kernels come with the extra `fast`")
        from prs_model.sweep.enclosed import kernels_ritz_jit as kernels  # type: ignore[no-redef]
    machine = changed(tmp_path, joints=GUIDE)
    poses = listed(machine)[:12]
    configurations = machine.kinematics.solve_batch(poses)
    dual = dual_assembly(machine.description, machine.parts, machine.joints, configurations)
    none, level = np.zeros((sum(each.size for each in dual.elements.values()), 0)), (2.0 * np.pi * 145.0) ** 2
    assert not kernels.below(packed(dual, none, -0.1 * level, level))[1].any()
    number, sure = kernels.below(packed(without_redundant(dual), none, -0.1 * level, level))
    assert sure.all()
    np.testing.assert_array_equal(number, (exact_at(machine, poses, 12) < 145.0).sum(axis=1))
