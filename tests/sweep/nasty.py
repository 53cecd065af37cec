"""A machine made to mislead sweeps: a turntable that carries an arm, a row of masses on springs, a plunger.

Modes feel each other little or not at all, and their frequencies are known:

* the table turns with sqrt(k / (J + m (x^2 + y^2))) / 2 pi, lower the further out the arm stands;
* the masses, a row of oscillators on the ground, do not care about the pose;
* the plunger moves on its guide against a spring that turns with the table, and is nearly loose where that is across.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, sqrt
from pathlib import Path

import numpy as np

import prs_model as prs

TABLE, LOOSE = 100.0, 5.0
"""Frequencies [Hz]: of the table with the arm on its axis, of the plunger with the spring across its guide."""

_INERTIA, _ARM, _STIFF = 0.1, 1.0, 1e10
_URDF = """<robot name="nasty">
  <link name="base"/><link name="disc"/><link name="slider"/><link name="arm"/>
  <joint name="turn" type="continuous"><parent link="base"/><child link="disc"/><axis xyz="0 0 1"/></joint>
  <joint name="slide_x" type="prismatic"><parent link="disc"/><child link="slider"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="slide_y" type="prismatic"><parent link="slider"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>
"""
_MACHINE = """name: nasty
urdf: nasty.urdf
task:
  kind: planar
  frame: arm
  workspace: {{x: [0, 1], y: [0, 1], phi: [-3, 3]}}
  reference: {{pose: {{x: 0.5, y: 0.5, phi: 0}}, joints: {{slide_x: 0.5, slide_y: 0.5, turn: 0}}}}
bodies:
  table: {{frame: disc, reducer: rigid, options: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: {inertia}}},
          nodes: {{axis: [0, 0, 0]}}}}, interfaces: {{axis: {{}}}}}}
  arm: {{frame: arm, reducer: rigid, options: {{mass: {arm}, inertia: {{xx: 1, yy: 1, zz: 1.0e-6}},
        nodes: {{hub: [0, 0, 0]}}}}, interfaces: {{hub: {{}}}}}}
  plunger: {{frame: base, reducer: rigid, options: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}},
            nodes: {{end: [0, 0, 0]}}}}, interfaces: {{end: {{}}}}}}
  row:
    frame: base
    reducer: lumped
    grounded: true
    options:
      nodes: {{{nodes}}}
      masses: {{{masses}}}
      springs: [{springs}]
joints:
  bearing: {{urdf: turn, between: [ground, table.axis], rigid: true,
            drive: {{kind: constant, rotational_stiffness: {table}}}}}
  ways:
    between: [table.axis, arm.hub]
    stages:
      - {{urdf: slide_x, rigid: true, drive: {{kind: constant, stiffness: {stiff}}}}}
      - {{urdf: slide_y, rigid: true, drive: {{kind: constant, stiffness: {stiff}}}}}
  guide: {{frame: base, between: [ground, plunger.end],
          stiffness: {{ux: {soft}, uy: rigid, uz: rigid, rx: rigid, ry: rigid, rz: rigid}}}}
  spring: {{frame: disc, between: [table.axis, plunger.end],
           stiffness: {{ux: {plunger}, uy: 0, uz: 0, rx: 0, ry: 0, rz: 0}}}}
output: {{node: arm.hub, frame: arm}}
"""


def nasty(folder: Path, row: Sequence[float], plunger: float) -> prs.Machine:
    """Write the machine's folder and load it. row: frequencies of the masses [Hz]; plunger: its highest one."""
    return _written(folder, _URDF, _MACHINE, row, plunger, _ARM)


def _written(folder: Path, urdf: str, machine: str, row: Sequence[float], plunger: float, arm: float) -> prs.Machine:
    names = [f"n{i}" for i in range(len(row))]
    k = [(2.0 * pi * each) ** 2 for each in row]
    springs = (
        f"{{between: [ground, {name}], stiffness: {{ux: {each!r}, uy: {_STIFF}, uz: {_STIFF}}}}}"
        for name, each in zip(names, k, strict=True)
    )
    text = machine.format(
        inertia=_INERTIA,
        arm=arm,
        stiff=_STIFF,
        soft=(2.0 * pi * LOOSE) ** 2,
        table=_INERTIA * (2.0 * pi * TABLE) ** 2,
        plunger=(2.0 * pi * plunger) ** 2,
        nodes=", ".join(f"{name}: [{i}, 0, 0]" for i, name in enumerate(names)),
        masses=", ".join(f"{name}: {{mass: 1}}" for name in names),
        springs=", ".join(springs),
    )
    (folder / "nasty.urdf").write_text(urdf)
    (folder / "machine.yaml").write_text(text)
    return prs.load_machine(folder)


_POLAR_URDF = """<robot name="nasty">
  <link name="base"/><link name="disc"/><link name="slider"/><link name="arm"/>
  <joint name="turn" type="continuous"><parent link="base"/><child link="disc"/><axis xyz="0 0 1"/></joint>
  <joint name="slide" type="prismatic"><parent link="disc"/><child link="slider"/><axis xyz="1 0 0"/>
    <limit lower="-0.00001" upper="3" effort="1" velocity="1"/></joint>
  <joint name="wrist" type="continuous"><parent link="slider"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>
"""
_POLAR = {
    "x: [0, 1], y: [0, 1]": "x: [-1, 1], y: [0.0001, 1]",
    "slide_x: 0.5, slide_y: 0.5, turn: 0": f"slide: {sqrt(0.5)!r}, turn: {pi / 4!r}, wrist: {-pi / 4!r}",
    "{{urdf: slide_x, ": "{{urdf: slide, ",
    "{{urdf: slide_y, rigid: true, drive: {{kind: constant, stiffness:": (
        "{{urdf: wrist, rigid: true, drive: {{kind: constant, rotational_stiffness:"
    ),
}


def polar(folder: Path, row: Sequence[float], plunger: float) -> prs.Machine:
    """The same, the arm on a slide on the table, which swings round within millimetres as the arm passes the axis."""
    text = _MACHINE
    for old, new in _POLAR.items():
        assert old in text
        text = text.replace(old, new)
    return _written(folder, _POLAR_URDF, text, row, plunger, arm=1e-6)


def table_frequency(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Of the table with the arm at (x, y) [m], as far as the ways are rigid [Hz]."""
    return np.asarray(TABLE * np.sqrt(_INERTIA / (_INERTIA + _ARM * (x**2 + y**2))))
