"""Time per pose of kinematics, assembly and eigenproblem, beside plain scipy.linalg.eigh on the same matrices."""

import time
from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import eigh

import prs_model as prs
from prs_model.synthesis import assemble_many


def median_time(action: Callable[[], object], repeats: int = 30) -> float:
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


@pytest.mark.benchmark
@pytest.mark.parametrize("name", ["head_3prs", "hexapod"])
def test_time_per_pose(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    machine = prs.load_machine(name)
    configuration = machine.configuration()
    system = machine.assemble(configuration)
    together = machine.kinematics.solve_batch(np.tile(list(machine.reference_pose.values()), (128, 1)))
    several = (machine.description, machine.parts, machine.joints, together)
    plain = median_time(lambda: eigh(system.stiffness, system.mass))
    rows = {
        "kinematics": median_time(machine.configuration),
        "assembly": median_time(lambda: machine.assemble(configuration)),
        "assembly of 128": median_time(lambda: assemble_many(*several)) / 128,
        "6 modes": median_time(lambda: system.modes(6)),
        "scipy eigh, all": plain,
        "scipy eigh, 6": median_time(lambda: eigh(system.stiffness, system.mass, subset_by_index=[0, 5])),
    }
    with capsys.disabled():
        print(f"\n{name}, {system.size} coordinates")
        for what, seconds in rows.items():
            print(f"  {what:<16} {seconds * 1e3:8.3f} ms  {seconds / plain:6.2f} x eigh")
    np.testing.assert_allclose(
        system.modes(6).eigenvalues, eigh(system.stiffness, system.mass, eigvals_only=True)[:6], rtol=1e-6
    )
