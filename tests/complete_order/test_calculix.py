"""CalculiX as an independent solver: one part of the head, and an assembly with every kind of joint end.

ccx integrates the mass of C3D10 with four points. With that rule here too all frequencies agree to its seven digits;
ours, exact, lies as little below as the mesh resolves the mode.
"""

import shutil
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_reducers import solid
from prs_reducers.elements.tetrahedra import Material, assemble
from prs_reducers.meshes.mesh_file import read_mesh
from tests.complete_order.calculix_deck import PlacedMesh, assembly_deck, frequencies, part_deck
from tests.meshes import STEEL, box, write

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")

URDF = """<robot name="arm">
  <link name="rail"/>
  <link name="carriage"/>
  <link name="across"/>
  <link name="arm"/>
  <link name="tip"/>
  <joint name="slide" type="prismatic">
    <parent link="rail"/><child link="carriage"/><axis xyz="1 0 0"/>
    <origin xyz="0 0.05 0.08"/><limit lower="0.1" upper="0.25" effort="1" velocity="1"/>
  </joint>
  <joint name="a" type="revolute">
    <parent link="carriage"/><child link="across"/><axis xyz="0 0 1"/>
    <origin xyz="0.05 0 0.06"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="b" type="revolute">
    <parent link="across"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0.25 0 0"/></joint>
</robot>
"""
MACHINE = """name: arm
urdf: arm.urdf
task:
  kind: xyz
  frame: tip
  workspace: {x: [0.3, 0.6], y: [-0.1, 0.2], z: [0, 0.3]}
  reference: {pose: {x: 0.5, y: 0.05, z: 0.14}, joints: {slide: 0.2, a: 0, b: 0}}
bodies:
  rail:
    frame: rail
    reducer: solid
    source: rail.msh
    units: m-N-kg-s
    options: {material: &steel {E: 2.1e11, nu: 0.3, density: 7850}}
    clamped: [x0]
    grounded: true
    interfaces:
      end: {set: x1}
      top:
        members:
          - {name: back, set: z1, box: {x: [-0.06, -0.02]}}
          - {name: front, set: z1, box: {x: [0.02, 0.06]}}
        travel: {joint: slide, along: [1, 0, 0], stations: [0.1, 0.15, 0.2, 0.25]}
  carriage:
    frame: carriage
    reducer: solid
    source: carriage.msh
    units: m-N-kg-s
    options: {material: *steel}
    interfaces:
      bottom:
        members:
          - {name: back, set: z0, box: {x: [-0.06, -0.02]}}
          - {name: front, set: z0, box: {x: [0.02, 0.06]}}
      pin: {set: z1, at: [0.05, 0, 0.06]}
  arm:
    frame: arm
    reducer: solid
    source: arm.msh
    units: m-N-kg-s
    options: {material: *steel}
    interfaces: {pin: {set: x0}, tip: {set: x1}}
joints:
  slide:
    urdf: slide
    between: [rail.top, carriage.bottom]
    interfaces:
      - {name: back, at: [-0.04, 0, 0], stiffness: {uy: 3.0e8, uz: 5.0e8, rx: 1.0e5, ry: 2.0e4, rz: 3.0e4}}
      - {name: front, at: [0.04, 0, 0], stiffness: {uy: 3.0e8, uz: 4.0e8, rx: 1.0e5, ry: 2.0e4, rz: 3.0e4}}
    drive: {kind: constant, stiffness: 1.0e8, at: [0, 0, 0.01]}
  pin:
    between: [carriage.pin, arm.pin]
    stages:
      - urdf: a
        stiffness: {ux: 4.0e8, uy: 4.0e8, uz: 6.0e8, rx: 1.0e5, ry: 1.0e5}
        drive: &motor {kind: constant, rotational_stiffness: 2.0e4}
      - urdf: b
        stiffness: {ux: 4.0e8, uy: 2.0e8, uz: 4.0e8, rx: 1.0e5, rz: 1.0e5}
        drive: *motor
  post:
    frame: rail
    between: [ground, rail.end]
    stiffness:
      - [5.0e6, 0, 0, 0, 2.0e5, 0]
      - [0, 4.0e6, 0, -3.0e5, 0, 0]
      - [0, 0, 6.0e6, 0, 0, 0]
      - [0, -3.0e5, 0, 5.0e4, 0, 0]
      - [2.0e5, 0, 0, 0, 4.0e4, 0]
      - [0, 0, 0, 0, 0, 3.0e4]
output: {node: arm.tip, frame: arm}
"""
POSES = {"straight": {}, "tilted": {"x": 0.4, "y": 0.13, "z": 0.07}}


def arm(folder: Path) -> prs.Machine:
    write(box((0.4, 0.1, 0.08), (20, 2, 1)), folder / "rail.msh")
    centred = np.array([0.06, 0.05, 0.0])
    write(box((0.12, 0.1, 0.06), (6, 2, 1), shape=lambda points: points - centred), folder / "carriage.msh")
    write(box((0.25, 0.06, 0.05), (4, 1, 1), shape=lambda points: points - [0.0, 0.03, 0.025]), folder / "arm.msh")
    (folder / "arm.urdf").write_text(URDF)
    (folder / "machine.yaml").write_text(MACHINE)
    return prs.load_machine(folder)


@pytest.fixture
def mass_of_ccx(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solid, "assemble", partial(assemble, mass_order=2))


@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
@pytest.mark.parametrize("pose", POSES)
@pytest.mark.usefixtures("mass_of_ccx")
def test_assembly(tmp_path, coupling, pose):
    machine = arm(tmp_path)
    configuration, complete = machine.configuration(**POSES[pose]), machine.complete_order(coupling)
    theirs = frequencies(assembly_deck(complete, configuration, 12), tmp_path)
    np.testing.assert_allclose(complete.modes(configuration, 8).frequencies, theirs[:8], rtol=1e-6)


def test_assembly_with_exact_mass(tmp_path):
    machine = arm(tmp_path)
    configuration, complete = machine.configuration(**POSES["tilted"]), machine.complete_order()
    theirs = frequencies(assembly_deck(complete, configuration, 12), tmp_path)
    np.testing.assert_allclose(complete.modes(configuration, 4).frequencies, theirs[:4], rtol=1e-4)


@pytest.mark.usefixtures("mass_of_ccx")
@pytest.mark.parametrize("held", [(), ("b1", "b2")], ids=["free", "held"])
def test_one_part_of_the_head(tmp_path, held):
    pytest.importorskip("gmsh", reason="gmsh meshes the rod", exc_type=(ImportError, OSError))
    from prs_machines.head_3prs.parts import PARTS

    source = tmp_path / "rod.msh"
    PARTS["rod"](4.0).write(source, "rod")
    part = prs.read_part("solid", source, units="mm-N-tonne-s", material=STEEL)
    nodes = np.array([node for name in held for node in part.node_sets[name]], dtype=int)
    mesh = PlacedMesh("rod", part.coordinates, read_mesh(source).elements, Material(*STEEL.values()), nodes)
    rigid = 0 if held else 6
    theirs = frequencies(part_deck(mesh, 20), tmp_path)[rigid : rigid + 8]
    np.testing.assert_allclose(part.clamp(held).frequencies(rigid + 8)[rigid:], theirs, rtol=1e-6)
