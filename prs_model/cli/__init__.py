"""The command line ``prs-model``."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from typing import Any

from .. import __version__
from ..errors import PrsError, short
from . import explore, frf, machines, modes, reduce, reducers, report, streams, validate, verify
from . import map as workspace_map

_COMMANDS = (modes, frf, workspace_map, report, explore, verify, reduce, validate, machines, reducers)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status is 0, 1 (the input is wrong: one clear message) or 2 (usage)."""
    streams.make_usable()
    options = _parser().parse_args(arguments)
    try:
        with streams.messages(quiet=options.quiet):
            _run(options)
    except PrsError as error:
        streams.complain(str(error))
    except BrokenPipeError:
        pass
    except KeyboardInterrupt:
        streams.complain("interrupted")
    except OSError as error:
        where = f"{short(error.filename)}: " if error.filename else ""
        streams.complain(f"{where}{error.strerror or error}")
    except Exception as error:
        if os.environ.get("PRS_MODEL_DEBUG"):
            raise
        what = f"{type(error).__name__}: {error}"
        streams.complain(f"internal error, please report it ({what}); set PRS_MODEL_DEBUG=1 to see where")
    else:
        return 0
    return 1


def _run(options: argparse.Namespace) -> None:
    stream = streams.results_alone() if options.json else streams.results()
    with redirect_stdout(sys.stderr):
        outcome: dict[str, Any] = options.run(options)
    text = json.dumps(outcome, indent=2, allow_nan=False) if options.json else options.show(outcome)
    streams.emit(text, stream)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="prs-model",
        description="Structural dynamics of parallel kinematic machines: natural frequencies and modes, pose by pose.",
    )
    parser.add_argument("--version", action="version", version=f"prs-model {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in _COMMANDS:
        sub = commands.add_parser(command.NAME, help=command.HELP, description=command.HELP)
        sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
        sub.add_argument("-q", "--quiet", action="store_true", help="no progress messages")
        command.add_arguments(sub)
        sub.set_defaults(run=command.run, show=command.show)
    return parser
