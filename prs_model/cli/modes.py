"""``prs-model modes``: natural frequencies and mode characters at one pose."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray
from ..readable import pose_text
from . import damping_argument, machine_argument, pose_argument
from .table import table
from .values import positive

if TYPE_CHECKING:
    from ..modes import Modes

NAME = "modes"
HELP = "natural frequencies, mode characters and energies at one pose"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the pose, and what to make of it."""
    pose_argument.add_machine_and_pose(parser)
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes (default 8)")
    damping_argument.add_damping(parser)
    machine_argument.add_settings(parser)
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the mode shapes (.png, .svg or .pdf)")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Solve, and draw where asked."""
    from ..response.damping import damping_of, in_words

    damping = damping_argument.damping_of(options)
    machine = machine_argument.changed(options)
    if options.picture is not None:
        from ..modes.picture import check_picture_file

        check_picture_file(options.picture)
    configuration = pose_argument.configuration_at(machine, options)
    system = machine.assemble(configuration)
    modes, model = system.modes(options.count), damping_of(system, damping)
    if options.picture is not None:
        from ..modes.picture import draw_modes

        place = pose_text(configuration.pose, machine.kinematics.task.coordinates)
        title = f"{machine.description.file.title or machine.name}\n{place}"
        draw_modes(modes, options.picture, title)
    return {
        **pose_argument.where(machine, configuration),
        "coordinates": modes.system.size,
        "requested": options.count,
        "frequencies_hz": [float(f) for f in modes.frequencies],
        "damping": damping if damping is not None else model.model_dump(mode="json", exclude_none=True),
        "damping_in_words": in_words(model),
        "modes": _table(modes, modes.damping_ratios(model)),
        "picture": None if options.picture is None else str(options.picture),
    }


def show(outcome: dict[str, Any]) -> str:
    """A table of modes under a line that says where."""
    rows: list[tuple[str, ...]] = [
        ("mode", "frequency/Hz", "damping", "what moves (share of kinetic energy)", "tool point", "strain energy")
    ]
    rows += [_row(mode) for mode in outcome["modes"]]
    if not any(mode["damping_ratio"] for mode in outcome["modes"]):
        rows = [(*row[:2], *row[3:]) for row in rows]
    heading = f"{pose_argument.heading(outcome)} ({outcome['coordinates']} coordinates; {outcome['damping_in_words']})"
    lines = [heading, "", table(rows)]
    if len(outcome["modes"]) < outcome["requested"]:
        lines += ["(all there are)"]
    if outcome["picture"]:
        lines += ["", f"mode shapes drawn in {outcome['picture']}"]
    return "\n".join(lines)


def _row(mode: dict[str, Any]) -> tuple[str, ...]:
    ratio = "" if mode["damping_ratio"] is None else f"{100.0 * mode['damping_ratio']:>5.2f} %"
    strain = ", ".join(f"{name} {share:.0%}" for name, share in mode["strain_shares"].items())
    return f"{mode['number']:>4}", f"{mode['frequency_hz']:>12.3f}", ratio, mode["character"], mode["output"], strain


def _table(modes: Modes, ratios: FloatArray) -> list[dict[str, Any]]:
    from ..modes import shares_by_group

    kinetic, strain, stems = modes.kinetic_energy(), modes.strain_energy(), modes.system.stems
    return [
        {
            "number": k + 1,
            "frequency_hz": float(modes.frequencies[k]),
            "damping_ratio": float(ratios[k]) if np.isfinite(ratios[k]) else None,
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
