"""The head's map beside others' eigenvalue solvers on the same matrices: Exudyn, SDynPy, pyYeti, SciPy."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import perf_counter

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh
from threadpoolctl import threadpool_limits

import prs_model as prs
from tests.benchmarks.sweep_cases import anywhere, cone

Array = NDArray[np.float64]
Solver = Callable[[Array, Array], Array]

POSES, ROUNDS = 24, 7


def by_scipy(stiffness: Array, mass: Array) -> Array:
    """All modes, with shapes."""
    return np.asarray(np.sqrt(eigh(stiffness, mass)[0][:6]) / (2.0 * np.pi))


def by_scipy_six(stiffness: Array, mass: Array) -> Array:
    """Six frequencies."""
    squares = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 5])
    return np.asarray(np.sqrt(squares) / (2.0 * np.pi))


def by_sdynpy() -> Solver:
    sdynpy = pytest.importorskip("sdynpy")

    def solve(stiffness: Array, mass: Array) -> Array:
        system = sdynpy.System(sdynpy.coordinate_array(np.arange(len(mass)) + 1, 1), mass, stiffness)
        return np.asarray(system.eigensolution(6).frequency)

    return solve


def by_pyyeti() -> Solver:
    tools = pytest.importorskip("pyyeti.ytools")

    def solve(stiffness: Array, mass: Array) -> Array:
        squares = tools.eig_si(stiffness, mass, p=6, tol=1e-9, verbose=False, rng=np.random.default_rng(1))[0]
        return np.asarray(np.sqrt(squares) / (2.0 * np.pi))

    return solve


def by_exudyn() -> Solver:
    exudyn, items = pytest.importorskip("exudyn"), pytest.importorskip("exudyn.itemInterface")

    def solve(stiffness: Array, mass: Array) -> Array:
        system, zeros = exudyn.SystemContainer().AddSystem(), np.zeros(len(mass))
        node = system.AddNode(
            items.NodeGenericODE2(
                numberOfODE2Coordinates=len(mass),
                referenceCoordinates=zeros,
                initialCoordinates=zeros,
                initialCoordinates_t=zeros,
            )
        )
        system.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=mass, stiffnessMatrix=stiffness))
        system.Assemble()
        return np.asarray(system.ComputeODE2Eigenvalues(convert2Frequencies=True)[0][:6])

    return solve


PEERS = {"SDynPy": by_sdynpy, "pyYeti": by_pyyeti, "Exudyn": by_exudyn}


@pytest.mark.benchmark
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("peer", PEERS)
def test_beside_a_peer(peer: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """One thread of theirs, all of ours, by turns."""
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    solvers: dict[str, Solver] = {"eigh": by_scipy, "eigh, six": by_scipy_six, peer: PEERS[peer]()}
    machine = prs.load_machine("head_3prs")
    poses = (dict(zip(machine.pose_names, pose, strict=True)) for pose in anywhere(machine, POSES).tolist())
    systems = [machine.assemble(machine.configuration(**pose)) for pose in poses]
    pencils = [(system.stiffness, system.mass) for system in systems]
    asked = cone(machine)
    machine.sweep(**asked)
    seconds: dict[str, list[float]] = {name: [] for name in ("sweep", *solvers)}
    with threadpool_limits(1):
        for _ in range(ROUNDS):
            seconds["sweep"].append(_seconds(partial(machine.sweep, **asked)) / 360_000)
            for name, solve in solvers.items():
                seconds[name].append(_seconds(partial(_each, solve, pencils)) / POSES)
    with capsys.disabled():
        print()
        for name, each in seconds.items():
            ratio = np.median(np.array(each) / np.array(seconds["sweep"]))
            print(f"{name:<10} {1e6 * np.median(each):10.2f} us/pose, {ratio:6.0f} x sweep")
    for pencil in pencils:
        np.testing.assert_allclose(solvers[peer](*pencil), by_scipy(*pencil), rtol=1e-6)
    assert np.median(seconds[peer]) > 50 * np.median(seconds["sweep"])


def _each(solve: Solver, pencils: list[tuple[Array, Array]]) -> None:
    for pencil in pencils:
        solve(*pencil)


def _seconds(action: Callable[[], object]) -> float:
    start = perf_counter()
    action()
    return perf_counter() - start
