"""The complete-order model against one monolithic matrix of the same assembly, and as a bound of reduced models."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from tests.complete_order.monolithic import monolithic_frequencies
from tests.meshes import STEEL, box, write

URDF = """<robot name="pair">
  <link name="lower"/>
  <link name="upper"/>
  <joint name="seat" type="fixed"><parent link="lower"/><child link="upper"/><origin xyz="0.3 0 0"/></joint>
</robot>
"""
MACHINE = """name: pair
urdf: pair.urdf
task: {{kind: fixed, frame: upper, workspace: {{}}, reference: {{pose: {{}}, joints: {{}}}}}}
reduction: {{coupling: {coupling}, tie: interface, modes: 8}}
bodies:
  lower:
    frame: lower
    reducer: solid
    source: lower.msh
    units: m-N-kg-s
    options: {{material: {steel}}}
    clamped: [x0]
    grounded: true
    interfaces: {{seat: {{set: x1}}}}
  upper:
    frame: upper
    reducer: solid
    source: upper.msh
    units: m-N-kg-s
    options: {{material: {steel}}}
    interfaces: {{seat: {{set: x0}}, tip: {{set: x1}}}}
joints:
  seat: {{frame: upper, between: [lower.seat, upper.seat], {law}}}
output: {{node: upper.tip, frame: upper}}
"""
ELASTIC = "stiffness: {ux: 4.0e8, uy: 2.0e8, uz: 2.0e8, rx: 3.0e5, ry: 5.0e5, rz: 5.0e5}"
RIGID = "rigid: true"
PARTLY = "stiffness: {ux: rigid, uy: 2.0e8, uz: rigid, rx: 3.0e5, ry: 5.0e5, rz: rigid}"


def pair(folder: Path, coupling: str, law: str) -> prs.Machine:
    write(box((0.3, 0.1, 0.08), (3, 1, 1)), folder / "lower.msh")
    write(box((0.2, 0.1, 0.08), (2, 1, 1)), folder / "upper.msh")
    (folder / "pair.urdf").write_text(URDF)
    (folder / "machine.yaml").write_text(MACHINE.format(coupling=coupling, law=law, steel=STEEL))
    return prs.load_machine(folder)


@pytest.mark.parametrize("law", [ELASTIC, PARTLY, RIGID], ids=["elastic", "partly rigid", "rigid"])
@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
def test_woodbury_equals_the_monolithic_matrix(tmp_path, coupling, law):
    machine = pair(tmp_path, coupling, law)
    complete = machine.complete_order(coupling)
    modes = complete.modes(machine.configuration(), 6)
    joined = complete.joined(machine.configuration())
    assert modes.frequencies == pytest.approx(monolithic_frequencies(joined, 6), rel=1e-8)
    assert modes.size == joined.size == sum(part.size for part in joined.bodies.values())


@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
def test_reduced_frequencies_lie_above(tmp_path, coupling):
    machine = pair(tmp_path, coupling, ELASTIC)
    complete = machine.complete_order(coupling).modes(machine.configuration(), 6)
    reduced = machine.modes(6).frequencies
    assert np.all(reduced >= complete.frequencies * (1.0 - 1e-9))
    assert reduced[:3] == pytest.approx(complete.frequencies[:3], rel=2e-3)


@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
def test_shapes_and_energies_are_those_of_the_reduced_modes(tmp_path, coupling):
    machine = pair(tmp_path, coupling, ELASTIC)
    complete, reduced = machine.complete_order(coupling).modes(machine.configuration(), 3).modes, machine.modes(3)
    assert complete.frequencies == pytest.approx(reduced.frequencies, rel=2e-3)
    for a, b in zip(seen(complete), seen(reduced), strict=True):
        assert (a @ b) ** 2 == pytest.approx((a @ a) * (b @ b), rel=2e-3)
    for energy in ("kinetic_energy", "strain_energy"):
        one, other = getattr(complete, energy)(), getattr(reduced, energy)()
        assert one.keys() == other.keys()
        assert all(one[name] == pytest.approx(other[name], abs=5e-3) for name in one)
    assert [(c.group, c.motion, c.output) for c in complete.characters()] == [
        (c.group, c.motion, c.output) for c in reduced.characters()
    ]


def seen(modes: prs.Modes) -> np.ndarray:
    """Motions of the output point and of the surface points of all bodies, a row for each mode."""
    surfaces = [e.surface.recovery @ modes.body_shapes(name) for name, e in modes.system.elements.items()]
    return np.vstack([modes.output_shapes, *(each.reshape(-1, each.shape[-1]) for each in surfaces)]).T


def test_a_solved_pose_is_found_again_until_something_changes(tmp_path, caplog):
    caplog.set_level("INFO")
    cache = tmp_path / "cache"
    machine = pair(tmp_path, "averaged", ELASTIC)
    first = machine.complete_order(cache=cache).modes(machine.configuration(), 4)
    caplog.clear()
    again = machine.complete_order(cache=cache).modes(machine.configuration(), 4)
    assert not caplog.records
    assert np.array_equal(again.frequencies, first.frequencies)
    assert seen(again.modes) == pytest.approx(seen(first.modes), abs=1e-3 * np.abs(seen(first.modes)).max())
    assert (again.seconds, again.size, again.iterations) == (first.seconds, first.size, first.iterations)
    softer = machine.replace({"joints.seat.stiffness.uy": 1.0e8})
    assert softer.complete_order(cache=cache).modes(machine.configuration(), 4).frequencies[0] < first.frequencies[0]
    rigid = machine.complete_order("rigid", cache=cache).modes(machine.configuration(), 4)
    assert np.all(rigid.frequencies > first.frequencies)
    write(box((0.2, 0.1, 0.09), (2, 1, 1)), tmp_path / "upper.msh")
    thicker = machine.complete_order(cache=cache).modes(machine.configuration(), 4)
    assert thicker.frequencies != pytest.approx(first.frequencies, rel=1e-3)


def test_damaged_files_of_the_cache_are_made_anew(tmp_path, caplog):
    machine = pair(tmp_path, "averaged", ELASTIC)
    first = machine.complete_order(cache=tmp_path / "cache").modes(machine.configuration(), 4)
    for name, damage in {"upper.npz": b"PK", "modes.json": b"{}"}.items():
        next((tmp_path / "cache").glob(f"*/{name}")).write_bytes(damage)
        caplog.clear()
        again = machine.complete_order(cache=tmp_path / "cache").modes(machine.configuration(), 4)
        assert "not used, and made anew" in caplog.text
        assert again.frequencies == pytest.approx(first.frequencies, rel=1e-12)


def test_high_modes_are_found_from_few_interfaces(tmp_path):
    machine = pair(tmp_path, "averaged", ELASTIC).replace(
        {"bodies.upper.interfaces": {"seat": {"set": "x0"}}, "output.node": "upper.seat"}
    )
    complete = machine.complete_order()
    modes = complete.modes(machine.configuration(), 30)
    expected = monolithic_frequencies(complete.joined(machine.configuration()), 30)
    assert modes.frequencies == pytest.approx(expected, rel=1e-8)


def test_no_modes_asked_for_is_said(tmp_path):
    machine = pair(tmp_path, "averaged", ELASTIC)
    with pytest.raises(prs.PrsError, match="found 0 modes asked for, expected a whole number above zero"):
        machine.complete_order().modes(machine.configuration(), 0)


def test_a_reduced_part_is_refused():
    machine = prs.load_machine("hexapod")
    with pytest.raises(prs.PartFileError, match="comes reduced: the complete order needs full matrices"):
        machine.complete_order().modes(machine.configuration())


BEAMS = """name: two
urdf: pair.urdf
task: {{kind: fixed, frame: upper, workspace: {{}}, reference: {{pose: {{}}, joints: {{}}}}}}
bodies:
  lower: {{frame: lower, reducer: beam, options: &bar {bar}, interfaces: {{root: {{node: root}}, tip: {{node: tip}}}}}}
  upper: {{frame: upper, reducer: beam, options: *bar, interfaces: {{root: {{node: root}}, tip: {{node: tip}}}}}}
joints:
  foot: {{frame: lower, between: [ground, lower.root], rigid: true}}
  seat:
    frame: upper
    between: [lower.tip, upper.root]
    stiffness: {{ux: 4.0e8, uy: 2.0e8, uz: 2.0e8, rx: 3.0e5, ry: 3.0e5, rz: 3.0e5}}
output: {{node: upper.tip, frame: upper}}
"""


@pytest.mark.parametrize("elements", [1, 2, 3])
def test_parts_of_fewer_dofs_than_the_subspace_wants(tmp_path, elements):
    """Beams of few nodes: all their motions are taken before the last block."""
    section = {"kind": "rectangle", "y": 0.05, "z": 0.02, "material": STEEL}
    member = {"between": ["root", "tip"], "section": "bar", "elements": elements}
    bar = {"nodes": {"root": [0, 0, 0], "tip": [0.3, 0, 0]}, "sections": {"bar": section}, "members": [member]}
    (tmp_path / "pair.urdf").write_text(URDF)
    (tmp_path / "machine.yaml").write_text(BEAMS.format(bar=bar))
    machine = prs.load_machine(tmp_path)
    complete = machine.complete_order()
    expected = monolithic_frequencies(complete.joined(machine.configuration()), 6)
    modes = complete.modes(machine.configuration(), 6)
    elastic = modes.frequencies > 0.0
    assert modes.frequencies[elastic] == pytest.approx(expected[elastic], rel=1e-7)
