"""``prs-model validate``: everything wrong with a machine description, at once."""

from __future__ import annotations

import argparse
from typing import Any

from ..description import json_schema
from ..errors import PrsError
from ..machine import Machine, load_machine

NAME = "validate"
HELP = "check a machine description, its URDF, its reference configuration and its parts"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, or --schema."""
    parser.add_argument("machine", nargs="?", help="installed name, machine.yaml or its folder")
    parser.add_argument("--schema", action="store_true", help="print the JSON schema of machine.yaml for editors")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Load the description, solve the reference configuration, build every part and synthesise once."""
    if options.schema:
        options.json = True
        return json_schema()
    if options.machine is None:
        raise PrsError("name a machine to check, or ask for --schema")
    machine = load_machine(options.machine)
    machine.kinematics  # noqa: B018 - checks the reference configuration
    return _card(machine)


def show(outcome: dict[str, Any]) -> str:
    """A few lines about a sound machine."""
    lines = [f"{outcome['machine']}: valid", f"  {outcome['title']}" if outcome["title"] else ""]
    lines += [
        f"  {len(outcome['bodies'])} bodies, {len(outcome['joints'])} joints, {outcome['coordinates']} coordinates"
    ]
    lines += [f"  {name:<14} {mass}" for name, mass in outcome["bodies"].items()]
    return "\n".join(line for line in lines if line)


def _card(machine: Machine) -> dict[str, Any]:
    system = machine.assemble()
    return {
        "machine": machine.name,
        "title": machine.description.file.title,
        "valid": True,
        "coordinates": system.size,
        "bodies": {
            name: "grounded" if element.grounded else f"{element.mass_properties().mass:.3f} kg"
            for name, element in system.elements.items()
        },
        "joints": list(machine.description.joints),
    }
