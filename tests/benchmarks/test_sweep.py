"""Maps of the workspace: seconds, ratio to dense eigh, errors, memory. Run with `pytest -m benchmark -s`; minutes each.

Every sweep runs in a process of its own (`sweep_worker`), its numba cache empty. Figures in docs/benchmarks.md.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.benchmarks.sweep_cases import CASES

Run = Callable[..., dict[str, Any]]
Print = Callable[..., None]

COLUMNS = (
    *("first/s", "warm/s", "CPU/s", "us/pose", "MiB"),
    *("x all", "x values", "x six", "x modes", "worst", "median", "stated"),
)


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Measures a case of `sweep_cases` in a fresh process."""

    def measured(case: str, **options: Any) -> dict[str, Any]:
        ours = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_CACHE_DIR": str(tmp_path / case)}
        command = [sys.executable, "-m", "tests.benchmarks.sweep_worker", case, json.dumps(options)]
        done = subprocess.run(command, env=os.environ | ours, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return dict(json.loads(done.stdout))

    return measured


@pytest.fixture
def show(capsys: pytest.CaptureFixture[str]) -> Print:
    def shown(*lines: str) -> None:
        with capsys.disabled():
            print("", *lines, sep="\n")

    return shown


@pytest.mark.benchmark
@pytest.mark.parametrize("case", ["head 100 x 3600", "head 100 x 3601"])
def test_the_map_of_the_head(run: Run, show: Print, case: str) -> None:
    """Six frequencies at 360,000 poses, with numba and without."""
    found = run(case, rounds=7, checks=2000, worst=200)
    lines = [head(), line(case, found)]
    if find_spec("numba"):
        lines.append(line("without numba", run(case, rounds=3, numba=False)))
    worst = found["worst"]
    show(*lines, f"furthest from {found['other']['how']}:", f"{worst['count']} poses, worst {worst['worst']:.1e}")
    assert_within_bounds(found)
    assert ratio(found, "all modes") > 100
    assert ratio(found, "six values") > 50


@pytest.mark.benchmark
@pytest.mark.parametrize("case", ["head 100 x 3600 x 5", "hexapod 80 x 80 x 80"])
def test_volumes(run: Run, show: Print, case: str) -> None:
    found = run(case, rounds=3, checks=300, worst=50, other=3e-7)
    show(head(), line(case, found), found["how"])
    assert_within_bounds(found)
    assert found["poses_solved"] < found["poses"] / 10


@pytest.mark.benchmark
@pytest.mark.parametrize("case", ["head list 100,000", "hexapod 6-d list 20,000"])
def test_lists(run: Run, show: Print, case: str) -> None:
    """Of three coordinates; of six, which are too many to interpolate."""
    found = run(case, rounds=1, checks=200)
    show(head(), line(case, found), found["how"])
    assert found["errors"]["worst"] < 1e-6


@pytest.mark.benchmark
def test_numbers_of_modes(run: Run, show: Print) -> None:
    cases = [f"head 100 x 3600, {count} modes" for count in (3, 10, 20)]
    found = {case: run(case, rounds=3, checks=300, worst=50) for case in cases}
    show(head(), *(line(case, each) for case, each in found.items()), *(each["how"] for each in found.values()))
    for each in found.values():
        assert_within_bounds(each)


@pytest.mark.benchmark
def test_cost_and_memory_beside_the_number_of_poses(run: Run, show: Print) -> None:
    sizes = ("10 x 100", "25 x 400", "60 x 600", "100 x 1000", "100 x 3600", "1000 x 3600")
    found = {size: run(f"head {size}", rounds=3, checks=50, dense=False) for size in sizes}
    show(head(), *(line(size, each) for size, each in found.items()))
    for each in found.values():
        assert_within_bounds(each)
    assert found["1000 x 3600"]["peak"] < 2048.0
    per_pose = [np.median(each["warm"]) / each["poses"] for each in found.values()]
    assert per_pose[-1] < per_pose[0] / 20.0


@pytest.mark.benchmark
def test_what_other_quantities_cost(run: Run, show: Print) -> None:
    cases = [case for case in CASES if case.startswith("head 60 x 600")]
    found = {case: run(case, rounds=3, checks=50, dense=False) for case in cases}
    alone = float(np.median(found["head 60 x 600"]["warm"]))
    rows = (f"{line(case, each)}  x {np.median(each['warm']) / alone:.1f}" for case, each in found.items())
    show(head(), *rows)
    for each in found.values():
        assert_within_bounds(each)


def ratio(found: Mapping[str, Any], solver: str) -> float:
    """Poses per second of the sweep beside two processes of eigh, median of the rounds."""
    rates = np.array(found["rates"][solver])
    return float(np.median(found["poses"] / np.array(found["warm"]) / rates)) if len(rates) else np.nan


def assert_within_bounds(found: Mapping[str, Any]) -> None:
    for each in (found.get("errors"), found.get("worst")):
        assert each is None or (each["worst"] < 1e-6 and each["of bound"] <= 1.0)


def head() -> str:
    return f"load {os.getloadavg()[0]:.1f}".ljust(28) + "".join(f"{column:>10}" for column in COLUMNS)


def line(name: str, found: Mapping[str, Any]) -> str:
    warm, errors = float(np.median(found["warm"])), found.get("errors", {"worst": np.nan, "median": np.nan})
    figures = (
        f"{found['first']:.2f}",
        f"{warm:.2f}",
        f"{np.median(found['cpu']):.2f}",
        f"{1e6 * warm / found['poses']:.2f}",
        f"{found['peak']:.0f}",
        *(f"{ratio(found, solver):.0f}" for solver in found["rates"]),
        f"{errors['worst']:.1e}",
        f"{errors['median']:.1e}",
        f"{found['relative_error_bound'] or np.nan:.1e}",
    )
    return name.ljust(28) + "".join(f"{figure:>10}" for figure in figures)
