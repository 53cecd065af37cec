"""A machine and a pose of it on the command line."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..machine import Machine
from ..readable import pose_text, readable, readable_range
from .values import assignment, dimension_of, pose_from, unit_of

if TYPE_CHECKING:
    from ..kinematics import Configuration

_log = logging.getLogger(__name__)
_SLACK = 1e-9  # m, rad: rounding of a pose at the edge of the workspace


def add_machine_and_pose(parser: argparse.ArgumentParser) -> None:
    """The machine, and ``--pose``."""
    parser.add_argument("machine", help="installed name, machine.yaml or its folder")
    parser.add_argument(
        "--pose",
        nargs="+",
        action="extend",
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help="such as nutation=10deg z=1275mm; bare numbers are m and rad; default: the reference pose",
    )


def configuration_at(machine: Machine, options: argparse.Namespace) -> Configuration:
    """The configuration at the pose that was given, with a warning where that is outside the workspace."""
    configuration = machine.configuration(**pose_from(options.pose, machine.kinematics.task.coordinates))
    for name, (low, high) in machine.workspace.items():
        value = configuration.pose[name]
        if not low - _SLACK <= value <= high + _SLACK:
            kind = machine.kinematics.task.coordinates[name]
            found, bounds = readable(value, kind), readable_range(low, high, kind)
            _log.warning("pose is outside the stated workspace: %s %s, workspace %s", name, found, bounds)
    return configuration


def where(machine: Machine, configuration: Configuration) -> dict[str, Any]:
    """Machine, pose and its units, as results carry them."""
    return {
        "machine": machine.name,
        "pose": {name: float(value) for name, value in configuration.pose.items()},
        "pose_units": {name: unit_of(kind) for name, kind in machine.kinematics.task.coordinates.items()},
    }


def heading(outcome: Mapping[str, Any]) -> str:
    """Such as ``hexapod at z 90 mm``, from a result with `where` in it."""
    pose = pose_text(outcome["pose"], {name: dimension_of(unit) for name, unit in outcome["pose_units"].items()})
    return f"{outcome['machine']}{f' at {pose}' if pose else ''}"
