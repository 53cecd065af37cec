"""``prs-model reducers``: what is installed."""

from __future__ import annotations

import argparse
from typing import Any

from ..plugins import list_reducers
from .table import table

NAME = "reducers"
HELP = "list the installed reducers"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Name and description of each."""
    return {"reducers": [{"name": name, "description": text} for name, text in list_reducers().items()]}


def show(outcome: dict[str, Any]) -> str:
    """A line each."""
    rows = [(row["name"], row["description"]) for row in outcome["reducers"]]
    return table(rows) if rows else "no reducer is installed"
