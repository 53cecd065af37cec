"""Limbs of one entry are one part, unless one of them is changed; and interfaces have nodes of their own."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from tests.meshes import STEEL, box, write

URDF = """<robot name="fork">
  <link name="frame"/>
  <link name="prong_1"/>
  <link name="prong_2"/>
  <joint name="seat_1" type="fixed"><parent link="frame"/><child link="prong_1"/></joint>
  <joint name="seat_2" type="fixed"><parent link="frame"/><child link="prong_2"/><origin xyz="0 0.5 0"/></joint>
</robot>
"""
MACHINE = f"""name: fork
urdf: fork.urdf
symmetry: {{limb: [1, 2]}}
task: {{kind: fixed, frame: frame, workspace: {{}}, reference: {{pose: {{}}, joints: {{}}}}}}
reduction: {{method: craig-bampton, coupling: averaged, tie: interface, modes: 8}}
bodies:
  prong:
    per: limb
    frame: prong_<limb>
    reducer: solid
    source: prong.msh
    units: m-N-kg-s
    options: {{material: {STEEL}}}
    interfaces:
      seat:
        members: [{{name: low, set: x0, box: {{z: [-0.01, 0.03]}}}}, {{name: high, set: x0, box: {{z: [0.05, 0.09]}}}}]
      tip: {{set: x1}}
joints:
  seat:
    per: limb
    frame: prong_<limb>
    between: [ground, prong_<limb>.seat]
    interfaces:
      - name: low
        at: [0, 0.05, 0.02]
        stiffness: &seat {{ux: 4.0e8, uy: 2.0e8, uz: 2.0e8, rx: 3.0e5, ry: 3.0e4, rz: 3.0e5}}
      - {{name: high, at: [0, 0.05, 0.06], stiffness: *seat}}
output: {{node: prong_1.tip, frame: frame}}
"""


@pytest.fixture
def machine(tmp_path: Path) -> prs.Machine:
    write(box((0.3, 0.1, 0.08), (3, 1, 2)), tmp_path / "prong.msh")
    write(box((0.2, 0.1, 0.08), (2, 1, 2)), tmp_path / "short.msh")
    (tmp_path / "fork.urdf").write_text(URDF)
    (tmp_path / "machine.yaml").write_text(MACHINE)
    return prs.load_machine(tmp_path)


def frequencies(machine: prs.Machine, cache: Path | None = None) -> np.ndarray:
    return machine.complete_order(cache=cache).modes(machine.configuration(), 6).frequencies


@pytest.mark.parametrize("limb", [1, 2])
@pytest.mark.parametrize("change", [{"source": "short.msh"}, {"options.material.E": 4.0e11}], ids=["source", "options"])
def test_a_limb_that_differs_is_a_part_of_its_own(machine, tmp_path, limb, change):
    """Apart from each other, the limbs have the modes of a machine of such limbs each."""
    cache = tmp_path / "cache"
    plain = frequencies(machine, cache)
    all_changed = frequencies(machine.replace({f"bodies.prong.{key}": value for key, value in change.items()}))
    changed = machine.replace({f"bodies.prong_{limb}.{key}": value for key, value in change.items()})
    expected = np.sort([*plain[::2], *all_changed[::2]])[:5]
    for place in (None, cache, cache):
        assert frequencies(changed, place)[:5] == pytest.approx(expected, rel=1e-6)
    assert frequencies(machine, cache) == pytest.approx(plain, rel=1e-9)


def test_an_interface_tied_to_one_node_has_one_for_each_member_here(machine):
    tied = machine.replace({"bodies.prong.interfaces.seat.tie": "joint"})
    found = tied.complete_order().joined(tied.configuration()).bodies
    assert [tie.node for tie in found["prong_1"].ties] == ["seat.low", "seat.high", "tip"]
    assert frequencies(tied) == pytest.approx(frequencies(machine), rel=1e-8)


def test_an_interface_keeps_the_coupling_that_it_asks_for(machine):
    stiff = machine.replace({"bodies.prong_2.interfaces.seat.coupling": "rigid"})
    found = stiff.complete_order().joined(stiff.configuration()).bodies
    assert [tie.coupling for tie in found["prong_2"].ties] == ["rigid", "rigid", "averaged"]
    assert [tie.coupling for tie in found["prong_1"].ties] == ["averaged"] * 3


def test_the_output_may_be_an_interface_with_members(machine):
    changed = machine.replace({"reduction.tie": "joint", "output.node": "prong_1.seat"})
    modes = changed.complete_order().modes(changed.configuration(), 2).modes
    assert modes.system.output_placement.translation == pytest.approx([0.0, 0.05, 0.04], abs=1e-6)
