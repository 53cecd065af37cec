"""Two rigid blocks and a row of three point masses, the one in the middle without mass; on the ground or free."""

from __future__ import annotations

from pathlib import Path

import prs_model as prs

_URDF = '<robot name="stick"><link name="base"/></robot>'
_MACHINE = """name: stick
urdf: stick.urdf
task: {kind: fixed, frame: base, workspace: {}, reference: {pose: {}, joints: {}}}
bodies:
  block: {frame: base, reducer: rigid, options: {mass: 3, inertia: {xx: 0.1, yy: 0.2, zz: 0.3},
          nodes: {below: [0, 0, 0], above: [0, 0, 0.2]}}, interfaces: {below: {}, above: {}}}
  row:
    frame: base
    reducer: lumped
    options:
      nodes: {a: [0, 0, 0.2], b: [0, 0.1, 0.4], c: [0, 0, 0.6]}
      masses:
        a: {mass: 1, inertia: {xx: 0.01, yy: 0.01, zz: 0.01}}
        c: {mass: 2, inertia: {xx: 0.02, yy: 0.01, zz: 0.03}}
      springs:
        - {between: [a, b], stiffness: {ux: 2.0e5, uy: 3.0e5, uz: 4.0e5, rx: 5.0e3, ry: 6.0e3, rz: 7.0e3}}
        - {between: [b, c], stiffness: {ux: 2.0e5, uy: 3.0e5, uz: 4.0e5, rx: 5.0e3, ry: 6.0e3, rz: 7.0e3}}
    interfaces: {a: {}, c: {}}
joints:
  seat: {frame: base, between: [block.above, row.a],
         stiffness: {ux: rigid, uy: 1.0e6, uz: rigid, rx: 1.0e4, ry: 1.0e4, rz: 1.0e4}}
FOOT
output: {node: row.c, frame: base}
"""
_FOOT = """  foot: {frame: base, between: [ground, block.below],
         stiffness: {ux: 1.0e6, uy: 1.0e6, uz: 1.0e6, rx: 1.0e4, ry: 1.0e4, rz: 1.0e4}}
"""


def stick(folder: Path, held: bool) -> prs.Machine:
    """Write the machine's folder and load it; `held` by its foot or free."""
    (folder / "stick.urdf").write_text(_URDF)
    (folder / "machine.yaml").write_text(_MACHINE.replace("FOOT\n", _FOOT if held else ""))
    return prs.load_machine(folder)
