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
    from .modes.mac import mac, pair_modes
    from .plugins import PartRequest, Reducer, list_machines, list_reducers
    from .reduction import SuperElement, TravellingElement, export, read_part, reduce
    from .report import write_report
    from .synthesis import System
    from .verification import VerificationReport, verify

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
    "VerificationReport": "verification",
    "export": "reduction",
    "list_machines": "plugins",
    "list_reducers": "plugins",
    "load_machine": "machine",
    "mac": "modes.mac",
    "pair_modes": "modes.mac",
    "read_part": "reduction",
    "reduce": "reduction",
    "verify": "verification",
    "write_report": "report",
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
    "VerificationReport",
    "__version__",
    "export",
    "list_machines",
    "list_reducers",
    "load_machine",
    "mac",
    "pair_modes",
    "read_part",
    "reduce",
    "verify",
    "write_report",
]


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("prs-model")
    if name in _LAZY:
        return getattr(import_module(f".{_LAZY[name]}", __name__), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
