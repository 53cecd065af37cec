"""``prs-model verify``: reduced models held against the complete order of the same machine."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..machine import Machine, load_machine
from . import machine_argument, pose_argument
from .grids import grid_from
from .table import table
from .values import assignment, positive
from .wording import command_line

if TYPE_CHECKING:
    from ..verification import VerificationReport

NAME = "verify"
HELP = "hold the reduced models of a machine against its complete finite-element order, pose by pose"

_WIDTH = 120


class Outcome(dict[str, Any]):
    """The reports as plain data, and as they are."""

    def __init__(self, reports: Sequence[VerificationReport], files: Sequence[Path]):
        from ..verification.plain import as_dict

        super().__init__(reports=[as_dict(each) for each in reports], files=[str(file) for file in files])
        self.reports = reports


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the poses, what is compared, and where the results go."""
    pose_argument.add_machine(parser)
    _add_poses(parser)
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes (default 8)")
    parser.add_argument(
        "--models",
        nargs="+",
        default=["A", "B"],
        help="complete models: A, interfaces averaged, B, rigid (default both)",
    )
    parser.add_argument(
        "--reductions",
        nargs="+",
        metavar="NAME",
        help="of rigid-joint (the paper's), rigid-interface, averaged-interface, joint-loaded (default all)",
    )
    parser.add_argument(
        "--curve", action="store_true", help="each reduction with 0, 1, 2, 3, 5, 10 modes in every part"
    )
    parser.add_argument(
        "--bounds", action="store_true", help="also with travelling contacts reduced where they are at every pose"
    )
    parser.add_argument(
        "--stiffness",
        nargs="+",
        type=_factor,
        default=[],
        metavar="FACTOR",
        help="again with the stiffness of all joints times these",
    )
    parser.add_argument(
        "--size",
        type=_factor,
        help="a quick look: element lengths times this, by the rebuild.py of the machine's folder",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="write results.md, results.json and pictures there"
    )
    parser.add_argument("--no-cache", action="store_true", help="compute everything anew, and keep nothing")
    machine_argument.add_settings(parser)


def _add_poses(parser: argparse.ArgumentParser) -> None:
    default = "the reference pose and those of the machine's verification section, else the bounds of its workspace"
    pose_argument.add_poses(parser, default)
    parser.add_argument(
        "--grid",
        nargs="+",
        action="extend",
        type=assignment,
        default=[],
        metavar="NAME=VALUES",
        help="every combination of such as nutation=10,20,30deg precession=0:80deg:3",
    )
    parser.add_argument("--random", type=positive, metavar="N", help="N more poses anywhere in the workspace")
    parser.add_argument("--seed", type=int, default=0, help="of the random poses (default 0)")


def run(options: argparse.Namespace) -> Outcome:
    """Verify the machine, or a coarser copy of it, and write where asked."""
    from ..verification.full_parts import rebuilt

    _check_output(options)
    if options.size is None:
        return _verified(machine_argument.changed(options), options)
    with rebuilt(load_machine(options.machine).description.folder, options.size) as folder:
        options.machine = folder
        return _verified(machine_argument.changed(options), options)


def show(outcome: Outcome) -> str:
    """All tables of all reports."""
    from ..verification.pages import stiffness_text
    from ..verification.tables import tables

    lines = []
    for report in outcome.reports:
        lines += [f"{report.machine}: {stiffness_text(report).lower()}, {len(report.poses)} poses", ""]
        for each in tables(report):
            lines += [each.heading, table([each.header, *each.rows]), *textwrap.wrap(each.note, _WIDTH), ""]
    return "\n".join([*lines, *(f"written to {file}" for file in outcome["files"])]).rstrip()


def _verified(machine: Machine, options: argparse.Namespace) -> Outcome:
    from ..verification import REDUCTIONS, curve_of, reductions_named, verify, with_joint_stiffness
    from ..verification.pages import write_all

    poses = _poses(machine, options)
    reductions = REDUCTIONS if options.reductions is None else reductions_named(options.reductions)
    settings = {"models": options.models, "reductions": reductions, "count": options.count, "cache": _cache(options)}
    curve = curve_of(reductions) if options.curve else ()
    reports = [verify(machine, poses, curve=curve, in_place=options.bounds, **settings)]
    for factor in options.stiffness:
        reports.append(verify(with_joint_stiffness(machine, factor), poses, joint_stiffness=factor, **settings))
    files = () if options.output is None else write_all(reports, options.output, command_line())
    return Outcome(reports, files)


def _poses(machine: Machine, options: argparse.Namespace) -> list[dict[str, float]]:
    from ..verification import default_poses, grid_poses, random_poses

    poses = pose_argument.poses_of(machine, options)
    poses += grid_poses(machine, grid_from(options.grid, machine.kinematics.task.coordinates)) if options.grid else ()
    poses = poses or list(default_poses(machine))
    return [*poses, *(random_poses(machine, options.random, options.seed) if options.random else ())]


def _check_output(options: argparse.Namespace) -> None:
    """Find out now what would keep the results from being written after the work."""
    if options.output is not None:
        from ..verification.pages import check_folder
        from ..verification.pictures import check_drawing

        check_folder(options.output)
        check_drawing()


def _cache(options: argparse.Namespace) -> Path | None:
    from platformdirs import user_cache_path

    if options.no_cache:
        return None
    folder = user_cache_path("prs-model", appauthor=False)
    return folder if options.size is None else folder / f"size_{options.size:g}"


def _factor(text: str) -> float:
    """A number above zero as an argparse type."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-3 <= value <= 1e3:
        raise argparse.ArgumentTypeError(f"found '{text}', expected a factor from 0.001 to 1000")
    return value
