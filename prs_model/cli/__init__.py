"""The command line ``prs-model``."""

from __future__ import annotations

import argparse
import json
import logging
import os
import sys
from collections.abc import Sequence
from typing import Any

from ..errors import PrsError
from . import machines, modes, reducers, validate

_COMMANDS = (modes, validate, machines, reducers)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status is 0, 1 (the input is wrong: one clear message) or 2 (usage)."""
    options = _parser().parse_args(arguments)
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(message)s")
    logging.getLogger("prs_model").setLevel(logging.WARNING if options.quiet else logging.INFO)
    try:
        outcome: dict[str, Any] = options.run(options)
        text = json.dumps(outcome, indent=2, allow_nan=False) if options.json else options.show(outcome)
        print(text, flush=True)
    except PrsError as error:
        print(f"prs-model: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        print("prs-model: interrupted", file=sys.stderr)
        return 1
    except Exception as error:
        if os.environ.get("PRS_MODEL_DEBUG"):
            raise
        print(
            f"prs-model: internal error, please report it ({type(error).__name__}: {error}); "
            "set PRS_MODEL_DEBUG=1 to see where",
            file=sys.stderr,
        )
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="prs-model",
        description="Structural dynamics of parallel kinematic machines: natural frequencies and modes, pose by pose.",
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in _COMMANDS:
        sub = commands.add_parser(command.NAME, help=command.HELP, description=command.HELP)
        sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
        sub.add_argument("-q", "--quiet", action="store_true", help="no progress messages")
        command.add_arguments(sub)
        sub.set_defaults(run=command.run, show=command.show)
    return parser
