"""Structural dynamics of parallel kinematic machines, pose by pose, from Craig-Bampton super-elements."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from .errors import (
    DescriptionError,
    MissingExtraError,
    PartFileError,
    PhysicsError,
    PluginError,
    PrsError,
    UnknownNameError,
    UnreachablePoseError,
)

if TYPE_CHECKING:
    from .description import MachineDescription
    from .description.schema import Section
    from .finite_elements import FiniteElementModel
    from .kinematics import Configuration, Kinematics
    from .kinematics.tasks import Task
    from .machine import Machine, load_machine
    from .modes import Modes
    from .plugins import PartRequest, Reducer, list_machines, list_reducers
    from .reduction import SuperElement, TravellingElement, export, read_part, reduce
    from .synthesis import System

    __version__: str

_LAZY = {
    "Configuration": "kinematics",
    "FiniteElementModel": "finite_elements",
    "Kinematics": "kinematics",
    "Machine": "machine",
    "MachineDescription": "description",
    "Modes": "modes",
    "PartRequest": "plugins",
    "Reducer": "plugins",
    "Section": "description.schema",
    "SuperElement": "reduction",
    "System": "synthesis",
    "Task": "kinematics.tasks",
    "TravellingElement": "reduction",
    "export": "reduction",
    "list_machines": "plugins",
    "list_reducers": "plugins",
    "load_machine": "machine",
    "read_part": "reduction",
    "reduce": "reduction",
}

__all__ = [
    "Configuration",
    "DescriptionError",
    "FiniteElementModel",
    "Kinematics",
    "Machine",
    "MachineDescription",
    "MissingExtraError",
    "Modes",
    "PartFileError",
    "PartRequest",
    "PhysicsError",
    "PluginError",
    "PrsError",
    "Reducer",
    "Section",
    "SuperElement",
    "System",
    "Task",
    "TravellingElement",
    "UnknownNameError",
    "UnreachablePoseError",
    "__version__",
    "export",
    "list_machines",
    "list_reducers",
    "load_machine",
    "read_part",
    "reduce",
]


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("prs-model")
    if name in _LAZY:
        return getattr(import_module(f".{_LAZY[name]}", __name__), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
