"""Poses, settings and options as they are written on the command line."""

from __future__ import annotations

import re
from argparse import ArgumentParser, ArgumentTypeError
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any, get_args

from ..description import parse_value
from ..description.units import SI, AngleUnit, Dimension, LengthUnit, Units
from ..description.yaml_loader import read_yaml
from ..errors import DescriptionError, PrsError, short

_ASSIGNMENT = re.compile(r"(?P<name>[^=\s]+)=(?P<value>.*)", re.DOTALL)
_NUMBER = re.compile(r"(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*(?P<unit>[A-Za-z]*)")

_SEVERAL = re.compile(r"[^\s,]+(\s*,\s*[^\s,]+)+")

_LENGTH, _ANGLE = Dimension(length=1), Dimension(angle=1)
_UNITS = {_LENGTH: ("length", get_args(LengthUnit)), _ANGLE: ("angle", get_args(AngleUnit))}


def add_assignments(parser: ArgumentParser, flag: str, dest: str, metavar: str, help: str) -> None:
    """An option such as ``--set PATH=VALUE`` that may be given several times; it gives pairs of texts."""
    parser.add_argument(
        flag, dest=dest, action="append", type=assignment, default=[], metavar=metavar, help=f"{help} (may be repeated)"
    )


def assignment(text: str) -> tuple[str, str]:
    """``name=value`` as an argparse type."""
    match = _ASSIGNMENT.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f"found '{text}', expected name=value")
    return match["name"], match["value"]


def pose_from(
    assignments: Sequence[tuple[str, str]], coordinates: Mapping[str, Dimension], option: str = "--pose"
) -> dict[str, float]:
    """Pose coordinates in SI from ``nutation=10deg z=1275mm``; bare numbers are SI. option: named in messages.

    Raises PrsError for a coordinate given twice, a value that is not a number, or a unit of the wrong kind.
    """
    pose: dict[str, float] = {}
    for name, text in assignments:
        if name in pose:
            raise PrsError(f"{option} {name}: given twice")
        pose[name] = _number(f"{option} {name}", text, coordinates.get(name))
    return pose


def settings_from(assignments: Sequence[tuple[str, str]]) -> dict[str, object]:
    """Changes for Machine.replace from ``joints.P.drive.nut=1.0e5`` or ``bodies.rod=@rod.yaml``.

    Values are read as in machine.yaml. Raises DescriptionError or PrsError for one that cannot be read.
    """
    return {name: value_of("--set", name, text) for name, text in assignments}


def value_of(option: str, name: str, text: str) -> Any:
    """The value of ``option name=text`` as in machine.yaml, or the content of a YAML file, ``@file``.

    Raises PrsError naming the option, or DescriptionError naming the file and its line.
    """
    if text.startswith("@"):
        return read_yaml(Path(text[1:])).value
    try:
        value = parse_value(text)
    except DescriptionError as error:
        raise PrsError(f"{option} {name}: found '{short(text)}': {_what(error)}") from error
    if isinstance(value, str) and _SEVERAL.fullmatch(value):
        raise PrsError(f"{option} {name}: found '{value}'; several are written in brackets: '{name}=[{value}]'")
    return value


def _what(error: DescriptionError) -> str:
    return "; ".join(problem.message for problem in error.problems)


def once(option: str, assignments: Sequence[tuple[str, str]]) -> dict[str, str]:
    """Assignments by name. Raises PrsError for one that is given twice."""
    given = dict(assignments)
    if len(given) < len(assignments):
        names = [name for name, _ in assignments]
        twice = next(name for name in names if names.count(name) > 1)
        raise PrsError(f"{option} {twice}: given twice")
    return given


def nested(option: str, assignments: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """``material.E=2.1e11`` as ``{"material": {"E": 2.1e11}}``; a later one may change an entry of an earlier mapping.

    Raises PrsError for one that is given twice, or stands below a value that is no mapping.
    """
    entries: dict[str, Any] = {}
    for path, text in once(option, assignments).items():
        *sections, last = path.split(".")
        entry = entries
        for section in sections:
            entry[section] = entry = _mapping(option, path, section, entry.get(section, {}))
        if isinstance(entry.get(last), Mapping):
            raise PrsError(f"{option} {path}: '{last}' has entries already, which this would replace; say it first")
        entry[last] = value_of(option, path, text)
    return entries


def _mapping(option: str, path: str, name: str, found: Any) -> dict[str, Any]:
    if not isinstance(found, Mapping):
        raise PrsError(f"{option} {path}: '{name}' has a value already, expected entries")
    return dict(found)


def positive(text: str) -> int:
    """A whole number above zero as an argparse type."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise ArgumentTypeError(f"found '{text}', expected a whole number above zero")
    return value


def _number(place: str, text: str, dimension: Dimension | None) -> float:
    match = _NUMBER.fullmatch(text.strip())
    if not match or not isfinite(float(match["number"])):
        raise PrsError(f"{place}: found '{text}', expected a number with or without a unit, such as 10deg or 1275mm")
    number, unit = float(match["number"]), match["unit"]
    if not unit or dimension is None:
        return number
    kind, known = _UNITS[dimension]
    if unit not in known:
        raise PrsError(f"{place}: found unit '{unit}', expected one of {', '.join(known)}")
    return number * dimension.factor(Units.model_validate({kind: unit}))


def unit_of(dimension: Dimension) -> str:
    """The SI unit of a pose coordinate."""
    return dimension.label(SI)


def dimension_of(unit: str) -> Dimension:
    """The dimension of a pose coordinate from its SI unit."""
    return _ANGLE if unit == unit_of(_ANGLE) else _LENGTH
