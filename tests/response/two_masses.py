"""Two masses in a row along x, each on a spring: ground - k1 - m1 - k2 - m2. All other motions are rigid."""

from pathlib import Path

import numpy as np

import prs_model as prs

M1, M2, K1, K2 = 3.0, 2.0, 4.0e4, 1.5e4

URDF = """<robot name="row">
  <link name="one"/>
  <link name="two"/>
  <joint name="between" type="fixed"><parent link="one"/><child link="two"/></joint>
</robot>
"""
MACHINE = """name: row
urdf: row.urdf
symmetry: {{place: [one, two]}}
task: {{kind: fixed, frame: two, workspace: {{}}, reference: {{pose: {{}}, joints: {{}}}}}}
bodies:
  one: {{frame: one, reducer: rigid, options: {{mass: 3.0, nodes: {{end: [0, 0, 0]}}}}, interfaces: {{end: {{}}}}}}
  two: {{frame: two, reducer: rigid, options: {{mass: 2.0, nodes: {{end: [0, 0, 0]}}}}, interfaces: {{end: {{}}}}}}
joints:
{ground}  spring: {{frame: one, between: [one.end, two.end], stiffness: {{ux: 1.5e4, {rigid}}}}}
{damping}output: {{node: two.end, frame: two}}
"""
GROUND = "  wall: {{frame: one, between: [ground, one.end], stiffness: {{ux: 4.0e4, {rigid}}}}}\n"
RIGID = "uy: rigid, uz: rigid, rx: rigid, ry: rigid, rz: rigid"


def row(folder: Path, damping: str = "", ground: bool = True) -> prs.Machine:
    """Write the machine and load it. damping: the content of its section; ground: whether the wall is there."""
    wall = GROUND.format(rigid=RIGID) if ground else ""
    section = f"damping: {{{damping}}}\n" if damping else ""
    (folder / "row.urdf").write_text(URDF)
    (folder / "machine.yaml").write_text(MACHINE.format(ground=wall, rigid=RIGID, damping=section))
    return prs.load_machine(folder)


def matrices(k1: complex = K1, k2: complex = K2) -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness (2, 2)."""
    return np.diag([M1, M2]), np.array([[k1 + k2, -k2], [-k2, k2]])


def receptance(frequency: float, k1: complex = K1, k2: complex = K2) -> np.ndarray:
    """(2, 2) at one frequency [Hz], springs with complex stiffness."""
    mass, stiffness = matrices(k1, k2)
    return np.linalg.inv(stiffness - (2.0 * np.pi * frequency) ** 2 * mass)
