"""Values of pose coordinates as they are written on the command line: ``10,20,30deg`` or ``0:30deg:4``."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from ..description.units import Dimension
from ..errors import PrsError
from .values import once, pose_from

_MOST = 1_000_000


def grid_from(
    assignments: Sequence[tuple[str, str]], coordinates: Mapping[str, Dimension]
) -> dict[str, tuple[float, ...]]:
    """Values in SI of each coordinate from ``nutation=10,20,30deg precession=0:80deg:3``, a list or first:last:count.

    A number without a unit has that of the last one of its list; where none has a unit all are SI. Raises PrsError.
    """
    return {name: _values(name, text, coordinates) for name, text in once("--grid", assignments).items()}


def _values(name: str, text: str, coordinates: Mapping[str, Dimension]) -> tuple[float, ...]:
    if ":" not in text:
        return _numbers(name, text.split(","), coordinates)
    first, last, count = _range(name, text)
    low, high = _numbers(name, (first, last), coordinates)
    if low == high:
        raise PrsError(f"--grid {name}: found '{text}' from a value to the same, expected two that differ")
    return tuple(np.linspace(low, high, count).tolist())


def _range(name: str, text: str) -> tuple[str, str, int]:
    pieces = text.split(":")
    if len(pieces) != 3 or not re.fullmatch(r"\s*[0-9]{1,9}\s*", pieces[-1]):
        expected = "expected a list such as 10,20,30deg or a range first:last:count such as 0:30deg:4"
        raise PrsError(f"--grid {name}: found '{text}', {expected}")
    count = int(pieces[-1])
    if not 2 <= count <= _MOST:
        expected = f"expected from 2 to {_MOST:,}; a single one is written without colons"
        raise PrsError(f"--grid {name}: found {count:,} values in '{text}', {expected}")
    return pieces[0], pieces[1], count


def _numbers(name: str, pieces: Sequence[str], coordinates: Mapping[str, Dimension]) -> tuple[float, ...]:
    unit = re.sub(r"^[^A-Za-z]*([eE][-+]?\d+)?\s*", "", pieces[-1])
    whole = [piece if re.search(r"[A-Za-z]\s*$", piece) else f"{piece}{unit}" for piece in pieces]
    return tuple(pose_from([(name, piece)], coordinates, "--grid")[name] for piece in whole)
