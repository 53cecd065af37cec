"""``prs-model machines``: what is installed."""

from __future__ import annotations

import argparse
from typing import Any

from ..description import load_description
from ..errors import PrsError
from ..plugins import list_machines, machine_folder
from .table import table

NAME = "machines"
HELP = "list the installed machines"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Name, title and folder of each, or what is wrong with it."""
    return {"machines": [_machine(name) for name in list_machines()]}


def show(outcome: dict[str, Any]) -> str:
    """A line each."""
    rows = [(row["name"], row["problem"] or row["title"], row["folder"] or "") for row in outcome["machines"]]
    return table(rows) if rows else "no machine is installed"


def _machine(name: str) -> dict[str, Any]:
    entry: dict[str, Any] = {"name": name, "title": "", "folder": None, "problem": None}
    try:
        folder = machine_folder(name)
        entry["folder"] = str(folder)
        entry["title"] = load_description(folder).file.title
    except PrsError as error:
        entry["problem"] = str(error).splitlines()[0]
    return entry
