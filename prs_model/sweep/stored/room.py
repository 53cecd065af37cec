"""Whether the results of a sweep have room in the memory of this computer."""

from __future__ import annotations

import os
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from ...errors import PrsError
from ..poses import Poses
from ..quantities import labels, variables
from ..request import Request

if TYPE_CHECKING:
    from ...machine import Machine


def check_room(machine: Machine, poses: Poses, request: Request) -> None:
    """Raise PrsError where the results of all poses are larger than the memory there is."""
    labelled = labels(machine, request)
    each = sum(
        prod(len(labelled[dim]) for dim in variable.dims) * np.dtype(variable.dtype).itemsize
        for variable in variables(request).values()
    )
    needed, there = each * poses.size, _memory()
    if there and needed > there:
        found = f"results of {poses.size:,} poses take {_text(needed)}, and this computer has {_text(there)} of memory"
        raise PrsError(f"sweep: {found}; ask for fewer, or keep them in a folder (store, with the extra 'cluster')")


def _memory() -> int:
    """Bytes; zero where the system does not say."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return 0


def _text(size: int) -> str:
    return f"{size / 1e9:,.1f} GB"
