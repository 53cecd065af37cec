"""The head with all its DOFs: time of the first pose and of further ones, peak memory, beside the reduced model.

Every combination of solver and coupling runs in a process of its own, on the threads that OMP_NUM_THREADS allows.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.plugins import machine_folder

POSES = ({}, {"nutation": 0.35, "precession": 0.7}, {"nutation": 0.52, "precession": 1.4})
WITHOUT_PARDISO = 'import sys; sys.modules["pypardiso"] = None\n'
SCRIPT = """
import json, resource, sys, time
import prs_model as prs
machine = prs.load_machine(sys.argv[1])
order = machine.complete_order(sys.argv[2])
runs = [order.modes(machine.configuration(**pose), 8) for pose in json.loads(sys.argv[3])]
print(json.dumps({
    "size": runs[0].size,
    "first": runs[0].seconds,
    "further": max(run.seconds for run in runs[1:]),
    "iterations": max(run.iterations for run in runs),
    "residual": max(float(run.residuals.max()) for run in runs),
    "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    "hz": [run.frequencies.tolist() for run in runs],
}))
"""


@pytest.mark.benchmark
def test_complete_order_of_the_head(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _write_head(tmp_path)
    reduced = _seconds_per_reduced_pose()
    solvers = {"SuperLU": WITHOUT_PARDISO} | ({"PARDISO": ""} if find_spec("pypardiso") else {})
    found = {
        (coupling, solver): _run(before + SCRIPT, tmp_path, coupling)
        for coupling in ("averaged", "rigid")
        for solver, before in solvers.items()
    }
    with capsys.disabled():
        size, threads = found["averaged", "SuperLU"]["size"], os.environ.get("OMP_NUM_THREADS", "all")
        print(f"\n{size} DOFs, threads: {threads} of {os.cpu_count()}; reduced: {reduced * 1e3:.1f} ms per pose")
        columns = ("first/s", "further/s", "x reduced", "peak/GiB", "iterations", "residual")
        print(f"{'':<20}" + "".join(f"{each:>12}" for each in columns))
        for names, run in found.items():
            figures = (
                *(f"{run[name]:.1f}" for name in ("first", "further")),
                f"{run['further'] / reduced:.0f}",
                f"{run['peak']:.2f}",
                str(run["iterations"]),
                f"{run['residual']:.1e}",
            )
            print(f"{', '.join(names):<20}" + "".join(f"{each:>12}" for each in figures))
    for (coupling, _), run in found.items():
        np.testing.assert_allclose(run["hz"], found[coupling, "SuperLU"]["hz"], rtol=1e-7)


def _write_head(folder: Path) -> None:
    from prs_machines.head_3prs.parts import PARTS

    for name in ("machine.yaml", "head_3prs.urdf"):
        shutil.copy(machine_folder("head_3prs") / name, folder)
    for stem, part in PARTS.items():
        part(1.0).write(folder / "mesh" / f"{stem}.msh", stem)


def _seconds_per_reduced_pose() -> float:
    machine = prs.load_machine("head_3prs")
    machine.modes(8)
    start = time.perf_counter()
    for pose in POSES:
        machine.modes(8, **pose)
    return (time.perf_counter() - start) / len(POSES)


def _run(script: str, folder: Path, coupling: str) -> dict[str, object]:
    done = subprocess.run(
        [sys.executable, "-c", script, str(folder), coupling, json.dumps(POSES)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout.splitlines()[-1]))
