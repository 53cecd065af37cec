"""``prs-model report``: one page to look at, with every figure, number and animation beside it."""

from __future__ import annotations

import argparse
from typing import Any

from . import damping_argument, machine_argument, pose_argument
from .values import positive
from .wording import command_line

NAME = "report"
HELP = "one self-contained page: mode shapes in 3D, frequency responses, weak modes, energies, sources of every number"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the poses, and where the report goes."""
    pose_argument.add_machine(parser)
    parser.add_argument("-o", "--output", required=True, metavar="DIR", help="folder of the report, made if need be")
    pose_argument.add_poses(parser, "the reference pose")
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes are shown (default 8)")
    damping_argument.add_damping(parser)
    parser.add_argument("--map", action="store_true", help="also a map of the frequencies over the workspace")
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Make the report."""
    from ..report import write_report
    from ..report.run import check_folder

    damping = damping_argument.damping_of(options)
    folder = check_folder(options.output, max(len(options.pose), 1))
    machine = machine_argument.changed(options)
    poses = pose_argument.poses_of(machine, options) or [{}]
    files = write_report(machine, folder, poses, options.count, damping, command_line(), options.map)
    return {"machine": machine.name, "page": str(files[0]), "files": [str(file) for file in files]}


def show(outcome: dict[str, Any]) -> str:
    """Where to look."""
    return f"report of {outcome['machine']}: {outcome['page']}\n({len(outcome['files'])} files beside each other)"
