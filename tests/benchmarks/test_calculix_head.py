"""The whole head by CalculiX: the first eight frequencies of its complete order at two poses.

The meshes are coarse and made here, about 2e5 DOFs together. With CalculiX's four-point mass both agree to the seven
digits that it prints; with the exact mass to 1e-5.
"""

import shutil
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.schema import Coupling
from prs_model.plugins import machine_folder
from prs_reducers import solid
from prs_reducers.elements.tetrahedra import assemble
from tests.complete_order.calculix_deck import assembly_deck, frequencies

SIZE = 2.5  # factor on element lengths
POSES = {"reference": {}, "tilted": {"nutation": np.radians(20.0), "precession": np.radians(40.0)}}


@pytest.mark.benchmark
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("coupling", ["averaged", "rigid"])
def test_head_by_calculix(
    coupling: Coupling, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = _coarse_head(tmp_path)
    configurations = {name: machine.configuration(**pose) for name, pose in POSES.items()}
    complete = machine.complete_order(coupling)
    exact = {name: complete.modes(each, 8).frequencies for name, each in configurations.items()}
    monkeypatch.setattr(solid, "assemble", partial(assemble, mass_order=2))
    complete = machine.complete_order(coupling)
    for name, configuration in configurations.items():
        ours = complete.modes(configuration, 8)
        deck, start = assembly_deck(complete, configuration, 12), time.perf_counter()
        theirs = frequencies(deck, tmp_path)[:8]
        seconds = time.perf_counter() - start
        with capsys.disabled():
            print(f"\n{coupling}, {name}, {ours.size} DOFs: ccx in {seconds:.0f} s")
            for title, found in (("exact mass", exact[name]), ("mass as ccx", ours.frequencies)):
                print(f"  {title:<12}" + "".join(f"{difference:>10.1e}" for difference in found / theirs - 1.0))
            print(f"  {'ccx/Hz':<12}" + "".join(f"{frequency:>10.3f}" for frequency in theirs))
        np.testing.assert_allclose(ours.frequencies, theirs, rtol=1e-6)
        np.testing.assert_allclose(exact[name], theirs, rtol=2e-5)


def _coarse_head(folder: Path) -> prs.Machine:
    from prs_machines.head_3prs.parts import PARTS

    for name in ("machine.yaml", "head_3prs.urdf"):
        shutil.copy(machine_folder("head_3prs") / name, folder)
    for stem, part in PARTS.items():
        part(SIZE).write(folder / "mesh" / f"{stem}.msh", stem)
    return prs.load_machine(folder)
