"""One sweep measured in a process of its own: python -m tests.benchmarks.sweep_worker CASE OPTIONS (JSON). Prints JSON.

Rounds take turns: dense eigh in two processes, the sweep once more. The matrices of eigh are made beforehand, so that
it is charged neither kinematics nor assembly; the sweep is charged everything but loading the machine.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from time import perf_counter, process_time
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray
from scipy.linalg import eigh

import prs_model as prs
from tests.benchmarks.sweep_cases import CASES, anywhere

Array = NDArray[np.float64]
Pencils = list[tuple[Array, Array]]

PROCESSES = 2
MATRICES, DENSE_POSES = 32, 192  # different poses, and how many are solved in a round
STRIPE = 50_021  # poses compared at once


def all_modes(stiffness: Array, mass: Array) -> Array:
    """Eigenvalues of the whole pencil, with all shapes."""
    return np.asarray(eigh(stiffness, mass)[0])


def all_values(stiffness: Array, mass: Array) -> Array:
    return np.asarray(eigh(stiffness, mass, eigvals_only=True))


def six_values(stiffness: Array, mass: Array) -> Array:
    return np.asarray(eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 5]))


SOLVERS: dict[str, Callable[[Array, Array], Array]] = {
    "all modes": all_modes,
    "all values": all_values,
    "six values": six_values,
}

WHOLE = "machine.modes"


def rate(name: str, pencils: Pencils, count: int = DENSE_POSES) -> float:
    """Poses per second of one thread."""
    solve = SOLVERS[name]
    start = perf_counter()
    for k in range(count):
        solve(*pencils[k % len(pencils)])
    return count / (perf_counter() - start)


def whole_rate(machine: prs.Machine) -> float:
    """Poses per second of one thread with kinematics and assembly, pose by pose."""
    poses = anywhere(machine, MATRICES)
    start = perf_counter()
    for pose in poses:
        machine.modes(6, **_named(machine, pose))
    return len(poses) / (perf_counter() - start)


def pencils_of(machine: prs.Machine, poses: Array) -> Pencils:
    """(K, M) at poses (N, d)."""
    systems = (machine.assemble(machine.configuration(**_named(machine, pose))) for pose in poses)
    return [(system.stiffness, system.mass) for system in systems]


def measure(
    case: str,
    rounds: int,
    checks: int = 0,
    worst: int = 0,
    other: float = 1e-8,
    numba: bool = True,
    dense: bool = True,
) -> dict[str, Any]:
    """Seconds of the sweep (first call, then rounds), poses per second of eigh, errors, peak memory [MiB].

    checks: random poses that are solved exactly; worst: and those furthest from a second sweep of tolerance `other`.
    """
    if not numba:
        sys.modules["numba"] = None  # type: ignore[assignment]
    name, arguments = CASES[case]
    machine = prs.load_machine(name)
    asked = arguments(machine)
    _ = machine.parts, machine.joints
    first, _, data = timed(machine, asked)
    result: dict[str, Any] = {"first": first, "poses": data["proof"].size, **told(data)}
    result["peak"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    result |= in_turn(machine, asked, rounds, dense)
    if checks:
        result["errors"] = errors(machine, data, np.random.default_rng(7).choice(result["poses"], checks, False))
    if worst:
        second = machine.sweep(**asked | {"tolerance": other})
        result["other"] = told(second)
        places, apart = furthest_apart(data, second, worst)
        result["apart"] = apart
        result["worst"] = errors(machine, data, places)
    return result


def timed(machine: prs.Machine, asked: dict[str, Any]) -> tuple[float, float, xarray.Dataset]:
    """Seconds, seconds of all cores together, and the dataset."""
    start, cpu = perf_counter(), process_time()
    data = machine.sweep(**asked)
    return perf_counter() - start, process_time() - cpu, data


def told(data: xarray.Dataset) -> dict[str, Any]:
    keys = ("how", "poses_interpolated", "poses_bounded", "poses_solved", "poses_unreachable", "relative_error_bound")
    return {key: data.attrs.get(f"certificate_{key}") for key in keys}


def in_turn(machine: prs.Machine, asked: dict[str, Any], rounds: int, dense: bool) -> dict[str, Any]:
    """Dense eigh and the sweep by turns."""
    names = (*SOLVERS, WHOLE)
    found: dict[str, Any] = {"warm": [], "cpu": [], "load": [], "rates": {name: [] for name in names}, "threads": []}
    pencils = pencils_of(machine, anywhere(machine, MATRICES)) if dense else []
    with processes(dense) as pool:
        for _ in range(rounds):
            for name in SOLVERS if dense else ():
                found["rates"][name].append(sum(pool.map(rate, [name] * PROCESSES, [pencils] * PROCESSES)))
            if dense:
                found["threads"].append(_in_threads(pencils))
                found["rates"][WHOLE].append(PROCESSES * whole_rate(machine))
            seconds, cpu, _ = timed(machine, asked)
            found["warm"].append(seconds)
            found["cpu"].append(cpu)
            found["load"].append(os.getloadavg()[0])
    return found


def _in_threads(pencils: Pencils) -> float:
    with ThreadPoolExecutor(PROCESSES) as pool:
        return sum(pool.map(rate, ["six values"] * PROCESSES, [pencils] * PROCESSES))


@contextmanager
def processes(wanted: bool) -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(PROCESSES, mp_context=get_context("spawn")) as pool:
        if wanted:
            some = [(np.eye(200), np.eye(200))]
            list(pool.map(rate, ["all modes"] * PROCESSES * 4, [some] * PROCESSES * 4))  # until all are there
        yield pool


def errors(machine: prs.Machine, data: xarray.Dataset, places: NDArray[np.intp]) -> dict[str, float]:
    """Relative, of frequencies at some poses beside eigh of the machine assembled there; and beside their bounds."""
    found, beside = [], []
    count, bounds = data.sizes["mode"], _flat(data, "bound")
    frequencies, reason = _flat(data, "frequency"), data["reason"].values.ravel()
    for place in places:
        if reason[place] == 0:
            squares = all_values(*pencils_of(machine, pose_of(machine, data, int(place))[None])[0])[:count]
            error = np.abs(frequencies[place] / (np.sqrt(squares) / (2.0 * np.pi)) - 1.0)
            found.append(error.max())
            beside.append((error / bounds[place]).max())
    return {"count": len(found), "worst": max(found), "median": float(np.median(found)), "of bound": max(beside)}


def furthest_apart(data: xarray.Dataset, other: xarray.Dataset, count: int) -> tuple[NDArray[np.intp], float]:
    """The poses at which two sweeps differ most, and by how much of a frequency."""
    ours, theirs = _flat(data, "frequency"), _flat(other, "frequency")
    stripes = range(0, len(ours), STRIPE)
    apart = np.concatenate([np.abs(ours[k : k + STRIPE] / theirs[k : k + STRIPE] - 1.0).max(axis=1) for k in stripes])
    apart = np.nan_to_num(apart)
    return np.argsort(apart)[-count:], float(apart.max())


def pose_of(machine: prs.Machine, data: xarray.Dataset, place: int) -> Array:
    """The pose (d,) of a number in C order."""
    dims = data["reason"].dims
    one = data.isel(dict(zip(dims, np.unravel_index(place, data["reason"].shape), strict=True)))
    return np.array([float(one[name]) for name in machine.pose_names])


def _named(machine: prs.Machine, pose: Array) -> dict[str, float]:
    return dict(zip(machine.pose_names, pose.tolist(), strict=True))


def _flat(data: xarray.Dataset, name: str) -> Array:
    return np.asarray(data[name].values.reshape(-1, data.sizes["mode"]))


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], **json.loads(sys.argv[2])), default=float))
