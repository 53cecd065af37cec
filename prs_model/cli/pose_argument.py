"""A machine and poses of it on the command line."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..machine import Machine
from ..readable import pose_text
from .values import assignment, dimension_of, pose_from, unit_of

if TYPE_CHECKING:
    from ..kinematics import Configuration

_log = logging.getLogger(__name__)


def add_machine_and_pose(parser: argparse.ArgumentParser) -> None:
    """The machine, and one ``--pose``."""
    add_machine(parser)
    _add_pose(parser, "extend", "bare numbers are m and rad; default: the reference pose")


def add_machine(parser: argparse.ArgumentParser) -> None:
    """The machine, by whatever names it."""
    parser.add_argument("machine", help="installed name, machine.yaml or its folder")


def add_poses(parser: argparse.ArgumentParser, default: str) -> None:
    """``--pose`` as often as there are poses. default: what holds without it, in words."""
    _add_pose(parser, "append", f"bare numbers are m and rad; may be repeated; default: {default}")


def poses_of(machine: Machine, options: argparse.Namespace) -> list[dict[str, float]]:
    """The poses [m, rad] that were given by `add_poses`."""
    return [pose_from(each, machine.kinematics.task.coordinates) for each in options.pose]


def configuration_at(machine: Machine, options: argparse.Namespace) -> Configuration:
    """The configuration at the pose that was given, with a warning where that is outside the workspace."""
    configuration = machine.configuration(**pose_from(options.pose, machine.kinematics.task.coordinates))
    for said in machine.outside_workspace(configuration.pose):
        _log.warning("pose is %s", said)
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


def _add_pose(parser: argparse.ArgumentParser, action: str, more: str) -> None:
    parser.add_argument(
        "--pose",
        nargs="+",
        action=action,
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help=f"such as nutation=10deg z=1275mm; {more}",
    )
