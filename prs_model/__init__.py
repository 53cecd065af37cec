"""Structural dynamics of parallel kinematic machines, pose by pose, from Craig-Bampton super-elements."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .errors import (
    DescriptionError,
    MissingExtraError,
    PartFileError,
    PhysicsError,
    PrsError,
    UnknownNameError,
    UnreachablePoseError,
)

if TYPE_CHECKING:
    from .finite_elements import FiniteElementModel
    from .machine import Machine, load_machine
    from .modes import Modes
    from .plugins import PartRequest, Reducer, list_machines, list_reducers
    from .reduction import SuperElement, TravellingElement, reduce
    from .synthesis import System

_LAZY = {
    "FiniteElementModel": "finite_elements",
    "Machine": "machine",
    "Modes": "modes",
    "PartRequest": "plugins",
    "Reducer": "plugins",
    "SuperElement": "reduction",
    "System": "synthesis",
    "TravellingElement": "reduction",
    "list_machines": "plugins",
    "list_reducers": "plugins",
    "load_machine": "machine",
    "reduce": "reduction",
}

__all__ = [
    "DescriptionError",
    "FiniteElementModel",
    "Machine",
    "MissingExtraError",
    "Modes",
    "PartFileError",
    "PartRequest",
    "PhysicsError",
    "PrsError",
    "Reducer",
    "SuperElement",
    "System",
    "TravellingElement",
    "UnknownNameError",
    "UnreachablePoseError",
    "list_machines",
    "list_reducers",
    "load_machine",
    "reduce",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(import_module(f".{_LAZY[name]}", __name__), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
