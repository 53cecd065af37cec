"""Tables of numbers in text files, read fast, and slowly where they need a closer look."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.errors import PartFileError, short
from prs_model.part_files.text import number


def read_table(text: str, path: Path, columns: int, *, separator: str | None = None, first_line: int = 1) -> FloatArray:
    """(m, columns): every line of `text` that is not empty. separator: None for white space, else such as a comma.

    first_line: the line of the file where `text` begins. Fortran exponents (1.5D+02) are read. Raises PartFileError
    naming the line that is wrong.
    """
    if not text.strip():
        return np.zeros((0, columns))
    try:
        table = np.loadtxt(io.StringIO(text.replace("D", "E")), delimiter=separator, comments=None, ndmin=2)
    except ValueError:
        return _line_by_line(text, path, columns, separator, first_line)
    return table if table.shape[1] == columns else _line_by_line(text, path, columns, separator, first_line)


def whole_numbers(table: FloatArray, path: Path, what: str) -> IntArray:
    """The same as integers. Raises PartFileError when some are none."""
    if not np.all(np.abs(table) < 1e15):
        raise PartFileError(path, f"{what}: found a number that is far too large: the file is damaged")
    whole = np.rint(table).astype(np.int64)
    wrong = np.argwhere(whole != table)
    if len(wrong):
        raise PartFileError(path, f"{what}: found {table[tuple(wrong[0])]:g}, expected whole numbers")
    return whole


def _line_by_line(text: str, path: Path, columns: int, separator: str | None, first_line: int) -> FloatArray:
    rows = []
    for place, line in enumerate(text.splitlines(), first_line):
        fields = line.split(separator)
        if not line.strip():
            continue
        values = [_number(field, path, place) for field in fields]
        if len(values) != columns:
            raise PartFileError(
                path, f"line {place}: found {len(values)} numbers, expected {columns}: {short(line.strip(), 60)}"
            )
        rows.append(values)
    return np.array(rows, dtype=float).reshape(-1, columns)


def _number(field: str, path: Path, line: int) -> float:
    try:
        return number(field)
    except ValueError as error:
        raise PartFileError(path, f"line {line}: found '{short(field, 40)}', expected a number") from error
