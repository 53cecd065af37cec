"""A machine on the command line, with entries of its description changed."""

from __future__ import annotations

import argparse

from ..machine import Machine, load_machine
from .values import add_assignments, settings_from


def add_settings(parser: argparse.ArgumentParser) -> None:
    """``--set``, for commands that take a machine."""
    add_assignments(
        parser,
        "--set",
        "settings",
        "PATH=VALUE",
        "change an entry of the description, such as joints.P.drive.nut=1.0e5; bodies.rod=@rod.yaml takes it from a "
        "file, in which sources are relative to the machine's folder",
    )


def changed(options: argparse.Namespace) -> Machine:
    """The machine that was named, with its settings. Raises PrsError as load_machine and Machine.replace do."""
    machine = load_machine(options.machine)
    return machine.replace(settings_from(options.settings)) if options.settings else machine
