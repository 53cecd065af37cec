"""A part of 100,000 DOFs with two interfaces: time and peak memory of its reduction, beside plain SciPy and ccx.

Each runs in a process of its own on the same matrices (ccx: on the same mesh), one after the other, on one thread.
"""

import json
import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import save_npz

from tests.meshes import STEEL, box, steel

CELLS = (38, 10, 10)
MODES = 3

LOAD = """
import json, resource, sys, time
from pathlib import Path
import numpy as np
from scipy.sparse import csr_array, load_npz
folder = Path(sys.argv[1])
K, M = (csr_array(load_npz(folder / f"{name}.npz")) for name in "KM")
part = np.load(folder / "part.npz")
start = time.perf_counter()
"""

WITHOUT_PARDISO = 'sys.modules["pypardiso"] = None\n'

OURS = """
from prs_model import FiniteElementModel
from prs_model.description.schema import Interface
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
model = FiniteElementModel(K, M, part["coordinates"], part["dofs"], node_sets={"x0": part["x0"], "x1": part["x1"]})
settings = Settings("rigid", "joint", MODES)
element = reduce_model(model, {"a": Interface(set="x0"), "b": Interface(set="x1")}, settings)
squares = np.diag(element.stiffness)[12:]
"""

SCIPY = """
from scipy.sparse.linalg import eigsh, splu
rows, x = part["dofs"], part["coordinates"]
T = np.zeros((len(rows), 12))
tied = np.zeros(len(rows), dtype=bool)
for k, name in enumerate(("x0", "x1")):
    nodes = part[name]
    centre = x[nodes].mean(axis=0)
    for row in np.flatnonzero(np.isin(rows[:, 0], nodes)):
        arm, axis = x[rows[row, 0]] - centre, np.eye(3)[rows[row, 1]]
        T[row, 6 * k : 6 * k + 6] = [*axis, *np.cross(arm, axis)]
        tied[row] = True
inner = np.flatnonzero(~tied)
Kii, Mii = K[inner][:, inner].tocsc(), M[inner][:, inner].tocsc()
shapes = T.copy()
shapes[inner] = -splu(Kii).solve((K @ T)[inner])
squares, modes = eigsh(Kii, MODES, Mii, sigma=0.0)
basis = np.hstack([shapes, np.zeros((len(rows), MODES))])
basis[inner, 12:] = modes
reduced = basis.T @ (K @ basis), basis.T @ (M @ basis)
"""

CCX = """
import subprocess
subprocess.run(["ccx", "part"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
text = (folder / "part.dat").read_text().split("\\n")
first = next(i for i, line in enumerate(text) if "E I G E N V A L U E" in line)
rows = [line.split() for line in text[first:] if line.split()[:1] in (["1"], ["2"], ["3"])]
squares = np.array([float(row[1]) for row in rows[:MODES]])
"""

REPORT = """
seconds = time.perf_counter() - start
who = resource.RUSAGE_CHILDREN if "subprocess" in globals() else resource.RUSAGE_SELF
peak = resource.getrusage(who).ru_maxrss / 1024
print(json.dumps({"seconds": seconds, "peak": peak, "hz": (np.sort(squares) ** 0.5 / (2 * np.pi)).tolist()}))
"""


@pytest.mark.benchmark
def test_reduction_of_100k_dofs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _write_part(tmp_path)
    found = {"prs-model, SuperLU": _run(WITHOUT_PARDISO + OURS, tmp_path), "SciPy alone": _run(SCIPY, tmp_path)}
    if find_spec("pypardiso"):
        found["prs-model, PARDISO"] = _run(OURS, tmp_path)
    if shutil.which("ccx"):
        found["ccx *FREQUENCY"] = _run(CCX, tmp_path)
    ours = found["prs-model, SuperLU"]
    with capsys.disabled():
        print(f"\n{'':<20}{'time/s':>10}{'ratio':>8}{'peak/MiB':>11}{'ratio':>8}   fixed-interface frequencies/Hz")
        for name, run in found.items():
            ratios = run["seconds"] / ours["seconds"], run["peak"] / ours["peak"]
            hz = "  ".join(f"{f:.2f}" for f in run["hz"])
            print(f"{name:<20}{run['seconds']:>10.2f}{ratios[0]:>8.2f}{run['peak']:>11.0f}{ratios[1]:>8.2f}   {hz}")
    np.testing.assert_allclose(ours["hz"], found["SciPy alone"]["hz"], rtol=1e-6)
    for run in found.values():
        np.testing.assert_allclose(ours["hz"], run["hz"], rtol=1e-3)


def _write_part(folder: Path) -> None:
    mesh = box((0.38, 0.1, 0.1), CELLS)
    model = steel(mesh)
    save_npz(folder / "K.npz", model.stiffness)
    save_npz(folder / "M.npz", model.mass)
    sets = {name: model.node_sets[name] for name in ("x0", "x1")}
    np.savez(folder / "part.npz", coordinates=model.coordinates, dofs=model.dofs, **sets)
    order = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]
    lines = ["*NODE", *(f"{i + 1},{x:.12g},{y:.12g},{z:.12g}" for i, (x, y, z) in enumerate(mesh.points))]
    lines += ["*ELEMENT,TYPE=C3D10,ELSET=ALL"]
    lines += [",".join(map(str, [i + 1, *(element[order] + 1)])) for i, element in enumerate(mesh.elements)]
    lines += ["*NSET,NSET=HELD", *(f"{node + 1}," for node in np.unique(np.concatenate(list(sets.values()))))]
    lines += ["*MATERIAL,NAME=STEEL", "*ELASTIC", f"{STEEL['E']},{STEEL['nu']}", "*DENSITY", f"{STEEL['density']}"]
    lines += ["*SOLID SECTION,ELSET=ALL,MATERIAL=STEEL", "*BOUNDARY", "HELD,1,3"]
    lines += ["*STEP", "*FREQUENCY", f"{MODES}", "*END STEP"]
    (folder / "part.inp").write_text("\n".join(lines) + "\n")


def _run(script: str, folder: Path) -> dict[str, object]:
    threads = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}
    text = f"MODES = {MODES}\n" + LOAD + script + REPORT
    done = subprocess.run(
        [sys.executable, "-c", text, str(folder)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | threads | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout.splitlines()[-1]))
