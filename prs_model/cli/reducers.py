"""``prs-model reducers``: what is installed."""

from __future__ import annotations

import argparse
from typing import Any

from ..errors import PluginError
from ..plugins import REDUCERS, names, reducer
from .table import table

NAME = "reducers"
HELP = "list the installed reducers"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Name and description of each, or what is wrong with it."""
    return {"reducers": [_reducer(name) for name in names(REDUCERS)]}


def show(outcome: dict[str, Any]) -> str:
    """A line each."""
    rows = [(row["name"], row["problem"] or row["description"]) for row in outcome["reducers"]]
    return table(rows) if rows else "no reducer is installed"


def _reducer(name: str) -> dict[str, Any]:
    try:
        return {"name": name, "description": reducer(name).description, "problem": None}
    except PluginError as error:
        return {"name": name, "description": "", "problem": str(error).splitlines()[0]}
