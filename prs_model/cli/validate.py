"""``prs-model validate``: everything wrong with a machine description, at once."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..description import json_schema
from ..machine import Machine
from ..synthesis import assemble
from . import machine_argument

if TYPE_CHECKING:
    from ..modes import Modes

NAME = "validate"
HELP = "check a machine description, its URDF, its reference configuration and its parts"
_MOVES = 0.01  # share of the kinetic energy


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, or --schema."""
    one = parser.add_mutually_exclusive_group(required=True)
    one.add_argument("machine", nargs="?", help="installed name, machine.yaml or its folder")
    one.add_argument("--schema", action="store_true", help="print the JSON schema of machine.yaml for editors")
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Load the description, solve the reference configuration, build every part, synthesise and solve once."""
    if options.schema:
        options.json = True
        return json_schema()
    return _card(machine_argument.changed(options))


def show(outcome: dict[str, Any]) -> str:
    """A few lines about a sound machine."""
    counts = f"{len(outcome['bodies'])} bodies, {len(outcome['joints'])} joints, {outcome['coordinates']} coordinates"
    lines = [f"{outcome['machine']}: valid"]
    lines += [f"  {outcome['title']}"] if outcome["title"] else []
    lines += [f"  {counts}, first frequency {outcome['first_frequency_hz']:.1f} Hz"]
    lines += [f"  {name:<14} {_mass(body)}" for name, body in outcome["bodies"].items()]
    lines += [f"  warning: {warning}" for warning in outcome["warnings"]]
    return "\n".join(lines)


def _mass(body: dict[str, Any]) -> str:
    return "grounded" if body["grounded"] else f"{body['mass_kg']:.3f} kg"


def _card(machine: Machine) -> dict[str, Any]:
    system = assemble(machine.description, machine.parts, machine.joints, machine.configuration())
    modes = system.modes(system.size)
    return {
        "machine": machine.name,
        "title": machine.description.file.title,
        "valid": True,
        "warnings": [*machine.loose_bodies(), *machine.wide_joints(), *_free(modes)],
        "coordinates": system.size,
        "first_frequency_hz": float(modes.frequencies[0]),
        "bodies": {
            name: {
                "mass_kg": None if element.grounded else float(element.mass_properties().mass),
                "grounded": element.grounded,
            }
            for name, element in system.elements.items()
        },
        "joints": list(machine.description.joints),
    }


def _free(modes: Modes) -> list[str]:
    count = int(modes.is_rigid.sum())
    if count == 0:
        return []
    moving = [name for name, share in modes.kinetic_energy().items() if share[modes.is_rigid].sum() > _MOVES * count]
    return [
        f"{count} of the modes have no frequency, {', '.join(moving)} moving freely; "
        "check for an axis without a drive, or a body that nothing holds"
    ]
