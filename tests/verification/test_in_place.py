"""Travelling contacts reduced where they are, as if a station were there."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.synthesis import assemble
from prs_model.verification.in_place import InPlace
from tests.meshes import STEEL, box, write
from tests.verification.gantry import TRAVEL, gantry


def slide(axis: int) -> str:
    return f"""<link name="rail_{axis}"/><link name="block_{axis}"/>
  <joint name="slide_{axis}" type="prismatic"><parent link="rail_{axis}"/><child link="block_{axis}"/>
    <origin xyz="0 0 0.1"/><axis xyz="1 0 0"/><limit lower="0" upper="0.3" effort="1" velocity="1"/></joint>"""


URDF = f"""<robot name="tower">{slide(1)}{slide(2)}{slide(3)}
  <joint name="seat_2" type="fixed"><parent link="block_1"/><child link="rail_2"/>
    <origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="seat_3" type="fixed"><parent link="block_2"/><child link="rail_3"/>
    <origin xyz="0 0 0.1" rpy="0 -1.5707963267948966 0"/></joint>
</robot>
"""
MACHINE = f"""name: tower
urdf: tower.urdf
symmetry: {{axis: [1, 2, 3]}}
task:
  kind: xyz
  frame: block_3
  workspace: {{x: [0.1, 0.2], y: [0, 0.1], z: [0.5, 0.6]}}
  reference: {{pose: {{x: 0.15, y: 0.05, z: 0.55}}, joints: {{slide_<axis>: 0.15}}}}
reduction: {{coupling: averaged, modes: 4}}
bodies:
  rail:
    per: axis
    frame: rail_<axis>
    reducer: solid
    source: rail.msh
    units: m-N-kg-s
    options: {{material: &steel {STEEL}}}
    interfaces:
      foot: {{set: x0}}
      top:
        set: z1
        box: {{x: [0, 0.1]}}
        travel: {{joint: slide_<axis>, along: [1, 0, 0], stations: [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]}}
  block:
    per: axis
    frame: block_<axis>
    reducer: solid
    source: block.msh
    units: m-N-kg-s
    options: {{material: *steel}}
    interfaces: {{bottom: {{set: z0}}, top: {{set: z1}}}}
joints:
  seat_1: {{frame: rail_1, between: [ground, rail_1.foot], rigid: true}}
  seat_2: {{frame: rail_2, between: [block_1.top, rail_2.foot], rigid: true}}
  seat_3: {{frame: rail_3, between: [block_2.top, rail_3.foot], rigid: true}}
  P:
    per: axis
    urdf: slide_<axis>
    between: [rail_<axis>.top, block_<axis>.bottom]
    stiffness: {{uy: 4.0e8, uz: 6.0e8, rx: 4.0e5, ry: 4.0e5, rz: 4.0e5}}
    drive: {{kind: constant, stiffness: 1.0e8}}
output: {{node: block_3.top, frame: block_3}}
"""


@pytest.fixture
def tower(tmp_path: Path) -> prs.Machine:
    write(box((0.4, 0.1, 0.1), (4, 1, 1)), tmp_path / "rail.msh")
    write(box((0.1, 0.1, 0.1), (1, 1, 1)), tmp_path / "block.msh")
    (tmp_path / "tower.urdf").write_text(URDF)
    (tmp_path / "machine.yaml").write_text(MACHINE)
    return prs.load_machine(tmp_path)


def frequencies(machine: prs.Machine, where: prs.Configuration) -> np.ndarray:
    parts = InPlace(machine).at(where)
    return assemble(machine.description, parts, machine.joints, where).modes(6).frequencies


@pytest.mark.parametrize("method", ["reduced", "stations"])
def test_in_place_is_what_one_station_there_gives(tmp_path, method):
    apart = {"reduction.tie": "interface", "reduction.coupling": "averaged"}
    machine = gantry(tmp_path, travel=TRAVEL).replace(apart | {"bodies.column.interfaces.rail.travel.method": method})
    for x in (0.445, 0.41):
        where = machine.configuration(x=x)
        found, exact = frequencies(machine, where), machine.complete_order().modes(where, 6).frequencies
        assert np.all(found > exact * (1.0 - 1e-8))
        assert found == pytest.approx(exact, rel=5e-3)


def test_at_a_station_nothing_changes(tmp_path):
    machine = gantry(tmp_path, travel=TRAVEL)
    assert frequencies(machine, machine.configuration(x=0.445)) == pytest.approx(
        machine.modes(6, x=0.445).frequencies, rel=1e-9
    )


@pytest.mark.parametrize("method", ["craig-bampton", "joint-loaded"])
@pytest.mark.parametrize("changes", [{"modes": 5}, {"options.material.E": 1.0e11}], ids=["modes", "material"])
def test_each_limb_has_its_own_part_in_place(tower, method, changes):
    machine = tower.replace(
        {f"bodies.rail_3.{key}": value for key, value in changes.items()} | {"reduction.method": method}
    )
    where = machine.configuration(x=0.17, y=0.07, z=0.57)
    found, exact = frequencies(machine, where), machine.complete_order().modes(where, 6).frequencies
    assert np.all(found > exact * (1.0 - 1e-8))
    assert found == pytest.approx(exact, rel=1e-2)
    if method == "craig-bampton":
        parts = InPlace(machine).at(where)
        assert all(parts[name].size == part.size for name, part in machine.parts.items())
