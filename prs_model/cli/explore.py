"""``prs-model explore``: a local page with the machine, and sliders for its pose and joints."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from typing import Any

from . import machine_argument, pose_argument
from .values import positive

NAME = "explore"
HELP = "a local page with sliders for pose and joints; the machine, its modes and its frequency response follow"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, where to start, and where the page is."""
    pose_argument.add_machine_and_pose(parser)
    parser.add_argument("-n", "--count", type=positive, default=8, help="how many modes (default 8)")
    parser.add_argument("--port", type=int, default=8080, help="of 127.0.0.1, 0 for any that is free (default 8080)")
    parser.add_argument("--browser", action="store_true", help="open the page in a browser")
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Serve the page until Ctrl-C."""
    from ..explore import explore
    from ..explore.server import check_port, check_viser

    check_viser()
    check_port(options.port)
    machine = machine_argument.changed(options)
    configuration = pose_argument.configuration_at(machine, options)
    how = {"count": options.count, "port": options.port, "browser": options.browser}
    solved = explore(machine, configuration.pose, **how, tell=partial(print, file=sys.stderr, flush=True))
    return {**pose_argument.where(machine, configuration), "solved": solved}


def show(outcome: dict[str, Any]) -> str:
    """What was done, in a line."""
    return f"{outcome['machine']}: {outcome['solved']} poses and stiffnesses solved"
