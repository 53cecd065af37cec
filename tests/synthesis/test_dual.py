"""The dual form against the primal one: as many eigenvalues below any shift, and the same motion under a load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.synthesis import dual_assembly
from prs_model.synthesis.redundancy import without_redundant
from tests.sweep.stick import stick
from tests.verification.gantry import TRAVEL, gantry

_URDF = '<robot name="knob"><link name="base"/></robot>'
_KNOB = """name: knob
urdf: knob.urdf
task: {kind: fixed, frame: base, workspace: {}, reference: {pose: {}, joints: {}}}
bodies:
  knob: {frame: base, reducer: rigid, options: {mass: 2, inertia: {xx: 0, yy: 0, zz: 0}, nodes: {a: [0, 0, 0]}},
         interfaces: {a: {}}}
  ball: {frame: base, reducer: rigid, options: {mass: 1, inertia: {xx: 0.1, yy: 0.1, zz: 0.1}, nodes: {a: [0, 0, 0]}},
         interfaces: {a: {}}}
joints:
  foot: {frame: base, between: [ground, knob.a],
         stiffness: {ux: 1.0e6, uy: 2.0e6, uz: 3.0e6, rx: 1.0e4, ry: 1.0e4, rz: 1.0e4}}
  stay: {frame: base, between: [knob.a, ball.a],
         stiffness: {ux: 1.0e6, uy: 1.0e6, uz: rigid, rx: 1.0e4, ry: 2.0e4, rz: 1.0e4}}
output: {node: ball.a, frame: base}
"""
_LEAF = """name: leaf
urdf: leaf.urdf
task: {kind: fixed, frame: base, workspace: {}, reference: {pose: {}, joints: {}}}
bodies:
  leaf:
    frame: base
    reducer: lumped
    options:
      nodes: {a: [0, 0, 0], b: [0.1, 0.2, 0.3]}
      masses: {}
      springs: [{between: [a, b], stiffness: {ux: 2.0e5, uy: 3.0e5, uz: 4.0e5, rx: 5.0e3, ry: 6.0e3, rz: 7.0e3}}]
    interfaces: {a: {}, b: {}}
  ball: {frame: base, reducer: rigid, options: {mass: 1, inertia: {xx: 0.1, yy: 0.2, zz: 0.3},
         nodes: {a: [0.1, 0.2, 0.3]}}, interfaces: {a: {}}}
joints:
  foot: {frame: base, between: [ground, leaf.a],
         stiffness: {ux: rigid, uy: rigid, uz: rigid, rx: 1.0e4, ry: rigid, rz: rigid}}
  tip: {frame: base, between: [leaf.b, ball.a],
        stiffness: {ux: rigid, uy: rigid, uz: rigid, rx: 1.0e4, ry: rigid, rz: rigid}}
TWICE
output: {node: ball.a, frame: base}
"""
_TWICE = """  tip2: {frame: base, between: [leaf.b, ball.a],
         stiffness: {ux: 0, uy: rigid, uz: rigid, rx: 0, ry: rigid, rz: rigid}}
"""


def knob(folder: Path) -> prs.Machine:
    """A point mass that only joints keep from turning, and a ball on it."""
    (folder / "knob.urdf").write_text(_URDF)
    (folder / "machine.yaml").write_text(_KNOB)
    return prs.load_machine(folder)


def leaf(folder: Path, twice: bool = False) -> prs.Machine:
    """A ball on a leaf without mass; joints between them may hold the same twice."""
    (folder / "leaf.urdf").write_text(_URDF.replace("knob", "leaf"))
    (folder / "machine.yaml").write_text(_LEAF.replace("TWICE\n", _TWICE if twice else ""))
    return prs.load_machine(folder)


MACHINES: dict[str, tuple[Callable[[Path], prs.Machine], list[list[float]]]] = {
    "travelling contact": (lambda folder: gantry(folder, travel=TRAVEL), [[0.37, 0.02, 0.0], [0.41, -0.01, -0.3]]),
    "rigid joints": (
        lambda _: prs.load_machine("hexapod"),
        [[0.0, 0.0, 0.09, 0.0, 0.0, 0.0], [0, 0.002, 0.09, 0.02, 0, 0]],
    ),
    "massless node": (lambda folder: stick(folder, held=True), [[]]),
    "free in space": (lambda folder: stick(folder, held=False), [[]]),
    "coordinates that only joints hold": (knob, [[]]),
    "a body without mass": (leaf, [[]]),
    "rigid joints that repeat each other": (lambda folder: leaf(folder, twice=True), [[]]),
}


@pytest.mark.parametrize("name", MACHINES)
def test_as_many_eigenvalues_lie_below_a_shift(name: str, tmp_path: Path) -> None:
    make, poses = MACHINES[name]
    machine = make(tmp_path)
    configurations = machine.kinematics.solve_batch(np.array(poses))
    dual = without_redundant(dual_assembly(machine.description, machine.parts, machine.joints, configurations))
    for i, pose in enumerate(poses):
        exact = machine.modes(40, **dict(zip(machine.pose_names, pose, strict=True))).eigenvalues
        exact = np.where(exact < 1e-6 * exact[-1], 0.0, exact)
        between = 0.5 * (exact[:-1] + exact[1:])[np.diff(exact) > 1e-3 * exact[1:]][:12]
        for shift in [-0.1 * exact[-1], *between]:
            S, below = dual.at(float(shift))
            scale = 1.0 / np.sqrt(np.abs(S[i]).max(axis=0))
            negative = int((np.linalg.eigvalsh(S[i] * np.outer(scale, scale)) < -1e-13).sum())
            assert below[i] - negative == int((exact < shift).sum())
        assert dual.size == S.shape[1]


def test_rigid_wrenches_that_repeat_others_are_left_out(tmp_path: Path) -> None:
    machine = leaf(tmp_path, twice=True)
    configurations = machine.kinematics.solve_batch(np.zeros((2, 0)))
    dual = dual_assembly(machine.description, machine.parts, machine.joints, configurations)
    assert list(without_redundant(dual).joints) == [each for each in dual.joints if each != "tip2"]
