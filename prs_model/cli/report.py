"""``prs-model report``: one page to look at, with every figure, number and animation beside it."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import Any

from . import machine_argument
from .values import assignment, pose_from, positive

NAME = "report"
HELP = "one self-contained page: mode shapes in 3D, frequency responses, weak modes, energies, sources of every number"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the poses, and where the report goes."""
    parser.add_argument("machine", help="installed name, machine.yaml or its folder")
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="DIR", help="folder of the report, made if need be"
    )
    parser.add_argument(
        "--pose",
        nargs="+",
        action="append",
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help="such as nutation=10deg z=1275mm (may be repeated); default: the reference pose",
    )
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes are shown (default 8)")
    parser.add_argument(
        "--damping",
        nargs="+",
        type=float,
        metavar="RATIO",
        help="modal damping ratio, one or one for each mode; default: as described",
    )
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Make the report."""
    from ..report import write_report
    from ..report.run import check_folder

    check_folder(options.output)
    machine = machine_argument.changed(options)
    kinds = machine.kinematics.task.coordinates
    poses = [pose_from(each, kinds) for each in options.pose] or [{}]
    files = write_report(machine, options.output, poses, options.count, options.damping, _command())
    return {"machine": machine.name, "page": str(files[0]), "files": [str(file) for file in files]}


def show(outcome: dict[str, Any]) -> str:
    """Where to look."""
    return f"report of {outcome['machine']}: {outcome['page']}\n({len(outcome['files'])} files beside each other)"


def _command() -> str:
    """The command line as it was given."""
    return shlex.join(["prs-model", *sys.argv[1:]])
