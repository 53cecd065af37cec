"""The argument ``-o FILE ..`` of commands that write several kinds of file, chosen by the suffix."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_outputs(parser: argparse.ArgumentParser, what: str) -> None:
    """``--output``, repeatable and taking several, as a list of paths. what: the kinds, in words."""
    parser.add_argument("-o", "--output", nargs="+", action="extend", type=Path, default=[], metavar="FILE", help=what)
