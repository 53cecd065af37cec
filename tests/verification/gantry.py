"""A small gantry whose parts are boxes of solid elements: column, table, saddle and arm, moved by x, y and phi.

The table rides on the column in two places. They stay where they are on the column, or travel along it with x.
"""

from pathlib import Path

import numpy as np

import prs_model as prs
from tests.meshes import STEEL, box, write

URDF = """<robot name="gantry">
  <link name="column"/><link name="table"/><link name="saddle"/><link name="arm"/>
  <joint name="slide_x" type="prismatic"><parent link="column"/><child link="table"/><origin xyz="0 0 0.3"/>
    <axis xyz="1 0 0"/><limit lower="-0.2" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="slide_y" type="prismatic"><parent link="table"/><child link="saddle"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-0.2" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="turn" type="revolute"><parent link="saddle"/><child link="arm"/><origin xyz="0.075 0.025 0.06"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
</robot>
"""
PART = """  {name}:
    frame: {name}
    reducer: solid
    source: {name}.msh
    units: m-N-kg-s
    options: {{material: {steel}}}
"""
MACHINE = """name: gantry
urdf: gantry.urdf
task:
  kind: planar
  frame: arm
  workspace: {{x: [0.275, 0.475], y: [-0.075, 0.125], phi: [-1, 1]}}
  reference: {{pose: {{x: 0.375, y: 0.025, phi: 0}}, joints: {{slide_x: 0, slide_y: 0, turn: 0}}}}
reduction: {{method: craig-bampton, modes: 2, store: reduced}}
bodies:
{column}    clamped: [z0]
    grounded: true
    interfaces:
      rail:
        at: [0.125, 0.05, 0.3]
        members:
          - {{name: near, set: z1, box: {{x: [-0.01, 0.11]}}}}
          - {{name: far, set: z1, box: {{x: [0.14, 0.26]}}}}
{travel}{table}    interfaces:
      rail:
        at: [0.125, 0.05, 0]
        members:
          - {{name: near, set: z0, box: {{x: [-0.01, 0.11]}}}}
          - {{name: far, set: z0, box: {{x: [0.14, 0.26]}}}}
      end: {{set: x1}}
{saddle}    interfaces: {{end: {{set: x0}}, top: {{set: z1, box: {{x: [0.04, 0.21]}}, at: [0.075, 0.025, 0.06]}}}}
{arm}    interfaces: {{foot: {{set: z0, box: {{x: [-0.01, 0.11]}}, at: [0, 0, 0]}}, tip: {{set: x1}}}}
joints:
  X:
    urdf: slide_x
    between: [column.rail, table.rail]
    interfaces:
      - {{name: near, at: [0.05, 0.05, 0], stiffness: &seat {{uy: 4.0e8, uz: 6.0e8, rx: 4.0e5, ry: 4.0e5, rz: 4.0e5}}}}
      - {{name: far, at: [0.2, 0.05, 0], stiffness: *seat}}
    drive: {{kind: constant, stiffness: 1.0e8}}
  Y:
    urdf: slide_y
    between: [table.end, saddle.end]
    stiffness: {{ux: 6.0e8, uz: 6.0e8, rx: 8.0e5, ry: 8.0e5, rz: 8.0e5}}
    drive: {{kind: constant, stiffness: 2.0e8}}
  R:
    urdf: turn
    between: [saddle.top, arm.foot]
    stiffness: {{ux: 9.0e8, uy: 9.0e8, uz: 9.0e8, rx: 9.0e5, ry: 9.0e5}}
    drive: {{kind: constant, rotational_stiffness: 5.0e5}}
output: {{node: arm.tip, frame: arm}}
{more}"""
TRAVEL = "        travel: {joint: slide_x, along: [1, 0, 0], stations: [-0.2, -0.07, 0.07, 0.2]}\n"
START = -0.2  # of the column along x
SIZES = {
    "column": ((0.7, 0.1, 0.3), (7, 1, 2)),
    "table": ((0.3, 0.1, 0.06), (3, 1, 1)),
    "saddle": ((0.2, 0.1, 0.06), (2, 1, 1)),
    "arm": ((0.3, 0.05, 0.05), (3, 1, 1)),
}


def gantry(folder: Path, more: str = "", travel: str = "") -> prs.Machine:
    """Write the machine's folder and load it. more: further sections of machine.yaml; travel: of the column's rail."""
    for name, (size, cells) in SIZES.items():
        start = START if name == "column" else 0.0
        write(box(size, cells, shape=lambda points, x=start: points + np.array([x, 0.0, 0.0])), folder / f"{name}.msh")
    parts = {name: PART.format(name=name, steel=STEEL) for name in SIZES}
    (folder / "gantry.urdf").write_text(URDF)
    (folder / "machine.yaml").write_text(MACHINE.format(**parts, more=more, travel=travel))
    return prs.load_machine(folder)
