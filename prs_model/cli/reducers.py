"""``prs-model reducers``: what is installed, and what one of them takes."""

from __future__ import annotations

import argparse
import inspect
from typing import Any

from ..errors import PluginError
from ..plugins import REDUCERS, names, reducer
from .options import entries
from .table import table

NAME = "reducers"
HELP = "list the installed reducers, or the options of one"

_GIVES = {
    "full": "full matrices, which are reduced here",
    "reduced": "reduced matrices, which stay as they are",
    "either": "full matrices, which are reduced here, or reduced ones",
}
_UNITS = {
    "asked": "not said by the file: --units, or 'units' in machine.yaml",
    "optional": "said by some files, else --units, or 'units' in machine.yaml",
    "SI": "always SI",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """One reducer, or none for all."""
    parser.add_argument("name", nargs="?", help="show the options of this one")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Name and description of each, or what is wrong with it; all that is to know of one."""
    if options.name is not None:
        return _known(options.name)
    return {"reducers": [_reducer(name) for name in names(REDUCERS)]}


def show(outcome: dict[str, Any]) -> str:
    """A line each; of one, what it reads and a table of its options."""
    if "options" in outcome:
        return _card(outcome)
    rows = [(row["name"], row["problem"] or row["description"]) for row in outcome["reducers"]]
    return table(rows) if rows else "no reducer is installed"


def _reducer(name: str) -> dict[str, Any]:
    try:
        return {"name": name, "description": reducer(name).description, "problem": None}
    except PluginError as error:
        return {"name": name, "description": "", "problem": str(error).splitlines()[0]}


def _known(name: str) -> dict[str, Any]:
    plugin = reducer(name)
    return {
        "name": name,
        "description": plugin.description,
        "needs_source": plugin.needs_source,
        "gives": plugin.gives,
        "units": plugin.units,
        "writes": list(plugin.writes),
        "about": inspect.cleandoc(plugin.Options.__doc__ or ""),
        "options": [each._asdict() for each in dict.fromkeys(entries(plugin.Options))],
    }


def _card(known: dict[str, Any]) -> str:
    rows = [("gives", _GIVES[known["gives"]])]
    rows += [("units of its file", _UNITS[known["units"]])] if known["needs_source"] else [("reads", "no file")]
    rows += [("writes", ", ".join(known["writes"]))] if known["writes"] else []
    lines = [f"{known['name']}: {known['description']}", "", table(rows), "", known["about"]]
    if known["options"]:
        options = [("option (--set NAME=VALUE, in SI)", "value", "default")]
        lines += ["", table([*options, *((each["name"], each["kind"], each["default"]) for each in known["options"])])]
    return "\n".join(lines)
