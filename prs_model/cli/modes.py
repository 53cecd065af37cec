"""``prs-model modes``: natural frequencies and mode characters at one pose."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..machine import Machine
from ..readable import pose_text, readable, readable_range
from . import machine_argument
from .table import table
from .values import assignment, dimension_of, pose_from, positive, unit_of

if TYPE_CHECKING:
    from ..kinematics import Configuration
    from ..modes import Modes

_log = logging.getLogger(__name__)
_SLACK = 1e-9  # m, rad: rounding of a pose at the edge of the workspace

NAME = "modes"
HELP = "natural frequencies, mode characters and energies at one pose"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the pose, and what to make of it."""
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
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes (default 8)")
    machine_argument.add_settings(parser)
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the mode shapes (.png, .svg or .pdf)")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Solve, and draw where asked."""
    machine = machine_argument.changed(options)
    if options.picture is not None:
        from ..modes.picture import check_picture_file

        check_picture_file(options.picture)
    configuration = machine.configuration(**pose_from(options.pose, machine.kinematics.task.coordinates))
    _warn_outside_workspace(machine, configuration)
    modes = machine.assemble(configuration).modes(options.count)
    if options.picture is not None:
        from ..modes.picture import draw_modes

        place = pose_text(configuration.pose, machine.kinematics.task.coordinates)
        title = f"{machine.description.file.title or machine.name}\n{place}"
        draw_modes(modes, options.picture, title)
    return {
        "machine": machine.name,
        "pose": {name: float(value) for name, value in configuration.pose.items()},
        "pose_units": {name: unit_of(kind) for name, kind in machine.kinematics.task.coordinates.items()},
        "coordinates": modes.system.size,
        "requested": options.count,
        "frequencies_hz": [float(f) for f in modes.frequencies],
        "modes": _table(modes),
        "picture": None if options.picture is None else str(options.picture),
    }


def show(outcome: dict[str, Any]) -> str:
    """A table of modes under a line that says where."""
    pose = pose_text(outcome["pose"], {name: dimension_of(unit) for name, unit in outcome["pose_units"].items()})
    rows = [("mode", "frequency/Hz", "what moves (share of kinetic energy)", "tool point", "strain energy")]
    rows += [_row(mode) for mode in outcome["modes"]]
    at = f" at {pose}" if pose else ""
    lines = [f"{outcome['machine']}{at} ({outcome['coordinates']} coordinates)", "", table(rows)]
    if len(outcome["modes"]) < outcome["requested"]:
        lines += ["(all there are)"]
    if outcome["picture"]:
        lines += ["", f"mode shapes drawn in {outcome['picture']}"]
    return "\n".join(lines)


def _row(mode: dict[str, Any]) -> tuple[str, str, str, str, str]:
    strain = ", ".join(f"{name} {share:.0%}" for name, share in mode["strain_shares"].items())
    return f"{mode['number']:>4}", f"{mode['frequency_hz']:>12.3f}", mode["character"], mode["output"], strain


def _table(modes: Modes) -> list[dict[str, Any]]:
    from ..modes import shares_by_group

    kinetic, strain, stems = modes.kinetic_energy(), modes.strain_energy(), modes.system.stems
    return [
        {
            "number": k + 1,
            "frequency_hz": float(modes.frequencies[k]),
            "character": str(character),
            "group": character.group,
            "motion": character.motion,
            "shares": dict(character.shares),
            "output": character.output,
            "strain_shares": shares_by_group({name: float(share[k]) for name, share in strain.items()}, stems),
            "kinetic_energy": {name: float(share[k]) for name, share in kinetic.items()},
            "strain_energy": {name: float(share[k]) for name, share in strain.items()},
        }
        for k, character in enumerate(modes.characters())
    ]


def _warn_outside_workspace(machine: Machine, configuration: Configuration) -> None:
    for name, (low, high) in machine.workspace.items():
        value = configuration.pose[name]
        if not low - _SLACK <= value <= high + _SLACK:
            kind = machine.kinematics.task.coordinates[name]
            found, bounds = readable(value, kind), readable_range(low, high, kind)
            _log.warning("pose is outside the stated workspace: %s %s, workspace %s", name, found, bounds)
