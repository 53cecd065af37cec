"""Poses and settings as they are written on the command line."""

from __future__ import annotations

import re
from argparse import ArgumentTypeError
from collections.abc import Mapping, Sequence
from math import isfinite

from ..description import parse_value
from ..description.units import Dimension, Units
from ..errors import PrsError

_ASSIGNMENT = re.compile(r"(?P<name>[^=\s]+)=(?P<value>.*)", re.DOTALL)
_NUMBER = re.compile(r"(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*(?P<unit>[A-Za-z]*)")

_LENGTHS = {"m": "m", "cm": "cm", "mm": "mm", "um": "um", "in": "in", "ft": "ft"}
_ANGLES = {"rad": "rad", "deg": "deg"}


def assignment(text: str) -> tuple[str, str]:
    """``name=value`` as an argparse type."""
    match = _ASSIGNMENT.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f"found '{text}', expected name=value")
    return match["name"], match["value"]


def pose_from(assignments: Sequence[tuple[str, str]], coordinates: Mapping[str, Dimension]) -> dict[str, float]:
    """Pose coordinates in SI from ``nutation=10deg z=1275mm``; bare numbers are SI.

    Raises PrsError for a coordinate given twice, a value that is not a number, or a unit of the wrong kind.
    """
    pose: dict[str, float] = {}
    for name, text in assignments:
        if name in pose:
            raise PrsError(f"--pose {name}: given twice")
        pose[name] = _number(name, text, coordinates.get(name))
    return pose


def settings_from(assignments: Sequence[tuple[str, str]]) -> dict[str, object]:
    """Changes for Machine.replace from ``bodies.rod.modes=5``, values read as in machine.yaml."""
    return {name: parse_value(text) for name, text in assignments}


def _number(name: str, text: str, dimension: Dimension | None) -> float:
    match = _NUMBER.fullmatch(text.strip())
    if not match or not isfinite(float(match["number"])):
        raise PrsError(
            f"--pose {name}: found '{text}', expected a number with or without a unit, such as 10deg or 1275mm"
        )
    unit = match["unit"]
    if not unit or dimension is None:
        return float(match["number"])
    if unit in _LENGTHS and dimension.length == 1:
        return float(match["number"]) * dimension.factor(Units.model_validate({"length": unit}))
    if unit in _ANGLES and dimension.angle == 1:
        return float(match["number"]) * dimension.factor(Units.model_validate({"angle": unit}))
    expected = _LENGTHS if dimension.length == 1 else _ANGLES
    raise PrsError(f"--pose {name}: found unit '{unit}', expected one of {', '.join(expected)}")
