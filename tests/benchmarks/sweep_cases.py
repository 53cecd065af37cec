"""The sweeps that are timed: by name, which machine and what Machine.sweep is asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prs_model import Machine

QUANTITIES: dict[str, dict[str, Any]] = {
    "compliance": {"quantities": "static_compliance"},
    "identity": {"quantities": "identity"},
    "shares": {"quantities": ("flexibility_share", "kinetic_energy", "strain_energy")},
    "peaks": {"quantities": "frf_peak", "band": (21.0, 227.0)},
}
SIZES = ((10, 100), (25, 400), (60, 600), (100, 1000), (100, 3600), (100, 3601), (1000, 3600))


def cone(_: Machine, nutations: int = 100, precessions: int = 3600, **others: Any) -> dict[str, Any]:
    """Nutation to 30 degrees, precession all the way round."""
    return {
        "nutation": np.radians(np.linspace(0.0, 30.0, nutations)),
        "precession": np.radians(np.linspace(0.0, 360.0, precessions)),
        "z": 1.275,
        **others,
    }


def anywhere(machine: Machine, count: int) -> NDArray[np.float64]:
    """Poses (count, d) at random in the workspace [m, rad]."""
    low, high = np.array([machine.workspace[name] for name in machine.pose_names]).T
    return np.asarray(np.random.default_rng(1).uniform(low, high, (count, len(low))))


def _listed(machine: Machine, count: int) -> dict[str, Any]:
    return {"poses": anywhere(machine, count)}


def _cube(machine: Machine, count: int) -> dict[str, Any]:
    return {name: np.linspace(*machine.workspace[name], count) for name in "xyz"}


CASES: dict[str, tuple[str, Callable[[Machine], dict[str, Any]]]] = {
    **{f"head {a} x {b}": ("head_3prs", partial(cone, nutations=a, precessions=b)) for a, b in SIZES},
    **{f"head 100 x 3600, {count} modes": ("head_3prs", partial(cone, n_modes=count)) for count in (3, 10, 20)},
    **{
        f"head 60 x 600, {name}": ("head_3prs", partial(cone, nutations=60, precessions=600, **asked))
        for name, asked in QUANTITIES.items()
    },
    "head 100 x 3600 x 5": ("head_3prs", partial(cone, z=np.linspace(1.175, 1.375, 5))),
    "head list 100,000": ("head_3prs", partial(_listed, count=100_000)),
    "hexapod 80 x 80 x 80": ("hexapod", partial(_cube, count=80)),
    "hexapod 6-d list 20,000": ("hexapod", partial(_listed, count=20_000)),
}
"""Machine and arguments of Machine.sweep."""
