"""Dense matrices as plain numbers in text, as Fortran programs print them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.errors import PartFileError, short
from prs_model.part_files.text import number

from ..tables.mtx import check_end

COMMENTS = ("#", "!", "%", "*", "$")
STIFFNESS, MASS = ("STIFF", "RIGID", "RAIDEUR"), ("MASS",)

_STARTS_A_NUMBER = re.compile(r"[-+.]?\d|[-+]\.\d")


def read_dense(text: str, path: Path, rows: int) -> dict[str, FloatArray]:
    """The square matrices of a text, each (rows, rows), row by row, with any count of numbers a line.

    A matrix may start with a line of its size (n, or n n) and with lines of words; where these say stiffness or mass
    (rigidite, raideur, masse) it is that one. Without such words the first is `first`, the next `second`.
    Raises PartFileError naming the line that is no number, or the count that does not fit.
    """
    check_end(text, path)
    found: dict[str, FloatArray] = {}
    titles, values = list[str](), list[float]()
    for count, kind, line in _lines(text):
        if kind == "numbers":
            if not values and _is_size(line, rows, count, path):
                continue
            values += _numbers(line, count, path)
            if len(values) > rows * rows:
                what = f"line {count}: the {rows}x{rows} matrix does not end with a line; is its size right?"
                raise PartFileError(path, what)
            if len(values) == rows * rows:
                found[_name(titles, found, path)] = np.array(values).reshape(rows, rows)
                titles, values = [], []
        elif not values:
            titles.append(line)
        elif kind == "title":
            raise _unfinished(values, rows, f"line {count}, '{short(line)}'", path)
    if values:
        raise _unfinished(values, rows, "the end of the file", path)
    return found


def _lines(text: str) -> Iterator[tuple[int, str, str]]:
    """Number, kind (comment, title or numbers) and content of each line that is not blank."""
    for count, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if line.startswith(COMMENTS):
            yield count, "comment", line
        elif line:
            yield count, "numbers" if _STARTS_A_NUMBER.match(line) else "title", line


def _is_size(line: str, rows: int, count: int, path: Path) -> bool:
    """Whether a line before a matrix is its size. Raises PartFileError when that is not the table's."""
    words = line.split()
    if len(words) > 2 or not all(word.isdigit() for word in words):
        return False
    if any(word.lstrip("0") != str(rows) for word in words):
        raise PartFileError(path, f"line {count}: a matrix of size {short(line)}, expected {rows} as the table of rows")
    return True


def _numbers(line: str, count: int, path: Path) -> list[float]:
    try:
        return [number(word) for word in line.split()]
    except ValueError as error:
        raise PartFileError(path, f"line {count}: {error}") from error


def _unfinished(values: list[float], rows: int, where: str, path: Path) -> PartFileError:
    half = rows * (rows + 1) // 2
    hint = "; it may be one triangle: write the whole matrix" if len(values) == half and rows > 1 else ": cut off"
    return PartFileError(path, f"found {len(values)} numbers before {where}, expected {rows * rows}{hint}")


def _name(titles: list[str], found: dict[str, FloatArray], path: Path) -> str:
    """What the last title that speaks of one of the two says, else the place in the file."""
    name = ("first", "second", "more")[min(len(found), 2)]
    for title in titles:
        is_stiffness, is_mass = (any(word in title.upper() for word in words) for words in (STIFFNESS, MASS))
        if is_stiffness != is_mass:
            name = "stiffness" if is_stiffness else "mass"
    if name in found or name == "more":
        raise PartFileError(path, f"holds {len(found) + 1} matrices or names one twice, expected stiffness and mass")
    return name
