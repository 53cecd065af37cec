"""Damping on the command line."""

from __future__ import annotations

import argparse

from ..errors import PrsError


def add_damping(parser: argparse.ArgumentParser) -> None:
    """``--damping``."""
    parser.add_argument(
        "--damping",
        nargs="+",
        metavar="RATIO",
        help="modal damping ratio, one or one for each mode above 0 Hz; default: as described",
    )


def damping_of(options: argparse.Namespace) -> list[float] | float | None:
    """One ratio for all modes, or one for each; None where the machine's own holds. Raises PrsError."""
    texts: list[str] | None = options.damping
    if texts is None:
        return None
    try:
        ratios = [float(text) for text in texts]
    except ValueError:
        raise PrsError(f"--damping: found '{' '.join(texts)}', expected a ratio such as 0.025, or several") from None
    return ratios[0] if len(ratios) == 1 else ratios
