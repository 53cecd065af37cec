"""Poses and settings as they are written on the command line."""

from __future__ import annotations

import re
from argparse import ArgumentTypeError
from collections.abc import Mapping, Sequence
from math import isfinite
from typing import get_args

from ..description import parse_value
from ..description.units import SI, AngleUnit, Dimension, LengthUnit, Units
from ..errors import PrsError

_ASSIGNMENT = re.compile(r"(?P<name>[^=\s]+)=(?P<value>.*)", re.DOTALL)
_NUMBER = re.compile(r"(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*(?P<unit>[A-Za-z]*)")

_LENGTH, _ANGLE = Dimension(length=1), Dimension(angle=1)
_UNITS = {_LENGTH: ("length", get_args(LengthUnit)), _ANGLE: ("angle", get_args(AngleUnit))}


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
    """Changes for Machine.replace from ``joints.P.drive.nut=1.0e5``, values read as in machine.yaml."""
    return {name: parse_value(text) for name, text in assignments}


def _number(name: str, text: str, dimension: Dimension | None) -> float:
    match = _NUMBER.fullmatch(text.strip())
    if not match or not isfinite(float(match["number"])):
        raise PrsError(
            f"--pose {name}: found '{text}', expected a number with or without a unit, such as 10deg or 1275mm"
        )
    number, unit = float(match["number"]), match["unit"]
    if not unit or dimension is None:
        return number
    kind, known = _UNITS[dimension]
    if unit not in known:
        raise PrsError(f"--pose {name}: found unit '{unit}', expected one of {', '.join(known)}")
    return number * dimension.factor(Units.model_validate({kind: unit}))


def unit_of(dimension: Dimension) -> str:
    """The SI unit of a pose coordinate."""
    return dimension.label(SI)


def dimension_of(unit: str) -> Dimension:
    """The dimension of a pose coordinate from its SI unit."""
    return _ANGLE if unit == unit_of(_ANGLE) else _LENGTH
