"""A list of poses from a CSV file: a header such as ``nutation [deg], z [mm]``, and a line each pose."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from ..arrays import FloatArray
from ..description.units import Dimension
from ..errors import PrsError, short
from ..machine import Machine
from ..plugins import unknown
from .values import pose_from

_COLUMN = re.compile(r"\s*(?P<name>[^\[\]\s]+)\s*(\[(?P<unit>[^\[\]]*)\])?\s*")


def poses_from_file(path: Path, machine: Machine) -> FloatArray:
    """Poses (N, d) [m, rad] in the machine's order; without a unit numbers are SI, columns left out the reference.

    Raises PrsError naming the file and the line for what cannot be read.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [(number, row) for number, row in enumerate(csv.reader(file), 1) if any(map(str.strip, row))]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise PrsError(f"{short(path)}: cannot be read as CSV ({error})") from error
    if len(rows) < 2:
        raise PrsError(f"{short(path)}: found no pose, expected a header such as {_example(machine)}, and a line each")
    columns = _columns(path, rows[0][1], machine)
    poses = np.tile(np.array(list(machine.reference_pose.values())), (len(rows) - 1, 1))
    for pose, (number, row) in zip(poses, rows[1:], strict=True):
        if len(row) != len(columns):
            raise PrsError(f"{short(path)}:{number}: found {len(row)} values, expected {len(columns)}")
        for (place, factor), text in zip(columns, row, strict=True):
            pose[place] = factor * _number(path, number, text)
    return poses


def _columns(path: Path, header: list[str], machine: Machine) -> list[tuple[int, float]]:
    """Which coordinate each column is, and the factor of its unit to SI."""
    found, coordinates = [], machine.kinematics.task.coordinates
    for text in header:
        match = _COLUMN.fullmatch(text)
        name, unit = (match["name"], match["unit"] or "") if match else (text, "")
        if name not in machine.pose_names:
            raise unknown(f"column in {short(path)}", name, list(machine.pose_names))
        found.append((machine.pose_names.index(name), _factor(path, name, unit.strip(), coordinates[name])))
    if len({place for place, _ in found}) < len(found):
        raise PrsError(f"{short(path)}:1: found a coordinate twice, expected each once")
    return found


def _factor(path: Path, name: str, unit: str, kind: Dimension) -> float:
    return pose_from([(name, f"1{unit}")], {name: kind}, f"{short(path)}:1:")[name]


def _number(path: Path, line: int, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise PrsError(f"{short(path)}:{line}: found '{short(text.strip())}', expected a number") from None


def _example(machine: Machine) -> str:
    kinds = machine.kinematics.task.coordinates
    return ", ".join(f"{name} [{'deg' if kinds[name].angle else 'mm'}]" for name in machine.pose_names)
