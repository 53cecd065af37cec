"""Two Nastran super-elements bolted together at 24 DOFs give the frequencies that Nastran printed for the pair."""

from pathlib import Path

import pytest

import prs_model as prs
from tests.superelements import DATA, needs_data

pytest.importorskip("pyyeti", reason="the extra 'nastran' reads OP4")

URDF = """<robot name="pair">
  <link name="outboard"/>
  <link name="inboard"/>
  <joint name="bolted" type="fixed"><parent link="outboard"/><child link="inboard"/></joint>
</robot>
"""
BODY = """
  {name}:
    frame: {name}
    reducer: nastran
    source: {source}
    units: in-lbf-slinch-s
    interfaces: {{g3: {{node: 3}}, g11: {{node: 11}}, g19: {{node: 19}}, g27: {{node: 27}}}}"""
JOINT = "\n  {name}: {{frame: outboard, between: [outboard.{name}, inboard.{name}], rigid: true}}"
MACHINE = """name: pair
urdf: pair.urdf
task: {{kind: fixed, frame: inboard, workspace: {{}}, reference: {{pose: {{}}, joints: {{}}}}}}
bodies:{bodies}
joints:{joints}
output: {{node: inboard.g3, frame: inboard}}
"""

# Elastic frequencies that Nastran printed: `assemble.out` of nas2cam_extseout, twmacro/pyyeti (BSD-3); and those that
# the same run stored, in single precision, in the table LAMA of nas2cam.op2, two of which end in another digit.
PRINTED = ("1.698800", "1.767487", "1.857720", "3.419612", "7.024210", "7.025409")
PRINTED += ("10.72361", "10.98255", "13.86679", "14.38990")
STORED = (1.698800, 1.767487, 1.857720, 3.419612, 7.024211, 7.025409, 10.72361, 10.98255, 13.86679, 14.38991)


@needs_data
def test_the_bolted_pair_has_the_frequencies_nastran_printed(tmp_path: Path) -> None:
    sources = {name: DATA / "nastran_extseout" / f"{name}.op4" for name in ("outboard", "inboard")}
    bodies = "".join(BODY.format(name=name, source=source) for name, source in sources.items())
    joints = "".join(JOINT.format(name=f"g{grid}") for grid in (3, 11, 19, 27))
    (tmp_path / "pair.urdf").write_text(URDF)
    (tmp_path / "machine.yaml").write_text(MACHINE.format(bodies=bodies, joints=joints))
    machine = prs.load_machine(tmp_path)
    system = machine.assemble()
    assert system.size == 46 + 32 - 24
    modes = system.modes(16)
    assert modes.is_rigid.sum() == 6
    found = modes.frequencies[6:]
    decimals = [len(text.partition(".")[2]) for text in PRINTED]
    assert tuple(round(f, n) for f, n in zip(found, decimals, strict=True)) == STORED
    for value, text, n in zip(found, PRINTED, decimals, strict=True):
        assert abs(value - float(text)) < 1.3 * 10.0**-n
