"""head_3prs with its rods exchanged: for a Nastran export of themselves, for beams, for lumped masses (run with -s).

The export is the same element, so the head is the same to round-off. Beams and lumps are made from the drawing (see
docs/examples/rod_four_ways.py): they lack the give of the solid hub and have the drawing's mass without its fillets and
overlaps, and so stand within 1.5 per cent. All in the paper's setting, whose elements Nastran's points can hold.
"""

from __future__ import annotations

import json
import os
import runpy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import prs_model as prs
from prs_model.cli import main
from prs_model.plugins import machine_folder
from prs_model.reduction.summary import summarize

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "examples" / "rod_four_ways.py"), run_name="rod")
NEAR = {"exported": 1e-8, "beam": 1.5e-2, "lumped": 1.5e-2}
METHOD = "reduction.method=craig-bampton"


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs").replace({"reduction.method": "craig-bampton"})


@pytest.fixture(scope="module")
def rods(head: prs.Machine, tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, dict[str, Any]]:
    """The rods' whole entry in machine.yaml, three ways."""
    pytest.importorskip("pyyeti", reason="pyyeti writes and reads .op4: pip install 'prs-model[nastran]'")
    file = tmp_path_factory.mktemp("export") / "rod.op4"
    exported = EXAMPLE["exported_rod"](head.parts["rod_1"], file)
    return {"exported": exported, "beam": EXAMPLE["beam_rod"](), "lumped": EXAMPLE["lumped_rod"]()}


def show(title: str, found: np.ndarray, solid: np.ndarray) -> None:
    print(f"\n{title}\nmode    solid / Hz      now / Hz    change")
    for k, (one, other) in enumerate(zip(solid, found, strict=True), start=1):
        print(f"{k:4}  {one:12.6f}  {other:12.6f}  {other / one - 1.0:+.1e}")


@pytest.mark.parametrize("way", NEAR)
def test_replaced(head: prs.Machine, rods: Mapping[str, dict[str, Any]], way: str) -> None:
    swapped = head.replace({"bodies.rod": rods[way]})
    solid, found = head.modes(8).frequencies, swapped.modes(8).frequencies
    show(f"machine.replace, rods {way}", found, solid)
    assert swapped.parts["rod_3"].provenance["reducer"] == rods[way]["reducer"]
    np.testing.assert_allclose(found, solid, rtol=NEAR[way])
    if way != "exported":
        assert np.all(found[:7] > solid[:7])  # the hub is rigid; mode 8 is bending of the bar


@pytest.mark.parametrize("way", NEAR)
def test_set_on_the_command_line(
    head: prs.Machine, rods: Mapping[str, dict[str, Any]], way: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """--set takes the same entry, as YAML or JSON; a path in it is absolute or relative to the machine's folder."""
    entry = dict(rods[way])
    if "source" in entry:
        entry["source"] = os.path.relpath(entry["source"], machine_folder("head_3prs"))
    assert main(["modes", "head_3prs", "--json", "--set", METHOD, "--set", f"bodies.rod={json.dumps(entry)}"]) == 0
    found = np.array(json.loads(capsys.readouterr().out)["frequencies_hz"])
    show(f"--set bodies.rod=.., rods {way}", found, head.modes(8).frequencies)
    np.testing.assert_allclose(found, head.replace({"bodies.rod": rods[way]}).modes(8).frequencies, rtol=1e-12)


def test_entries_one_by_one(head: prs.Machine, rods: Mapping[str, dict[str, Any]]) -> None:
    """Several entries of a body change together; they are checked when all of them are in place."""
    changes = {f"bodies.rod.{name}": value for name, value in rods["beam"].items() if name not in ("per", "frame")}
    found = head.replace({"bodies.rod.source": None, "bodies.rod.units": None, **changes}).modes(4).frequencies
    np.testing.assert_allclose(found, head.replace({"bodies.rod": rods["beam"]}).modes(4).frequencies, rtol=1e-12)
    with pytest.raises(prs.DescriptionError, match=r"bodies\.rod\.source: found .* expected nothing"):
        head.replace(changes)


def test_one_limb_alone(head: prs.Machine, rods: Mapping[str, dict[str, Any]]) -> None:
    """A machine may mix methods: one rod exported, one of beams, one as it was."""
    second, third = ({**rods[way], "per": None} for way in ("exported", "beam"))
    changes = {"bodies.rod_2": second | {"frame": "rod_2"}, "bodies.rod_3": third | {"frame": "rod_3"}}
    found, solid = head.replace(changes).modes(8).frequencies, head.modes(8).frequencies
    assert np.all(found[:7] >= solid[:7] * (1.0 - 1e-9))
    np.testing.assert_allclose(found, solid, rtol=NEAR["beam"])


@pytest.mark.parametrize("way", ["beam", "lumped"])
def test_the_rod_itself(head: prs.Machine, rods: Mapping[str, dict[str, Any]], way: str) -> None:
    """Mass within 3 %, the first bending frequency of the free rod within 4 %."""
    solid, found = head.parts["rod_1"], head.replace({"bodies.rod": rods[way]}).parts["rod_1"]
    assert isinstance(solid, prs.SuperElement)
    assert isinstance(found, prs.SuperElement)
    assert found.mass_properties().mass == pytest.approx(solid.mass_properties().mass, rel=0.03)
    assert summarize(found).free[0] == pytest.approx(summarize(solid).free[0], rel=0.04)
