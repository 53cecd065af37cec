"""The map of the workspace in the report: how the frequencies change from pose to pose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import PrsError
from ..readable import pose_text
from ..sweep import Request, poses_of, sweep
from ..sweep.files import save
from ..sweep.summary import summary
from .figures import Figure

if TYPE_CHECKING:
    from ..machine import Machine

NAME = "map"
_SUFFIXES = ("png", "svg", "csv")
_MOST = 6  # modes drawn
_COUNTS = (31, 91)  # values of the first and of the second coordinate


def workspace_map(machine: Machine, folder: Path, count: int) -> tuple[Figure, tuple[str, ...]]:
    """Sweep the first two coordinates that the workspace lets vary, the others at the reference; draw and write it.

    Returns the figure and its files in `folder`. Raises PrsError for a machine with nothing to vary.
    """
    ranges = {name: bounds for name, bounds in machine.workspace.items() if bounds[1] > bounds[0]}
    if not ranges:
        raise PrsError(f"map: the workspace of '{machine.name}' has no coordinate that varies, expected at least one")
    grid = {name: np.linspace(*ranges[name], number) for name, number in zip(ranges, _COUNTS, strict=False)}
    data = sweep(machine, poses_of(machine, grid), Request(min(count, _MOST)))
    files = tuple(f"{NAME}.{suffix}" for suffix in _SUFFIXES)
    for name in files:
        save(data, folder / name)
    return Figure(NAME, _caption(machine, grid), _words(machine, summary(machine, data))), files


def _caption(machine: Machine, grid: dict[str, Any]) -> str:
    kinds = machine.kinematics.task.coordinates
    others = {name: value for name, value in machine.reference_pose.items() if name not in grid}
    fixed = pose_text(others, {name: kinds[name] for name in others})
    return f"Natural frequencies over {' and '.join(grid)}" + (f", at {fixed}." if fixed else ".")


def _words(machine: Machine, found: dict[str, Any]) -> str:
    """Where each mode is lowest, and how much is out of reach."""
    kinds = machine.kinematics.task.coordinates
    lowest = [
        f"mode {each['number']} {each['lowest_hz']:.4g} Hz at {pose_text(each['lowest_at'], kinds)}"
        for each in found["modes"]
    ]
    missed = sum(each["poses"] for each in found["unreachable"])
    return f"{found['poses']} poses, {missed} of them out of reach. Lowest: {'; '.join(lowest)}."
