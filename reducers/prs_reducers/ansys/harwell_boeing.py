"""Harwell-Boeing files of assembled real matrices, symmetric (RSA) or not (RUA); SciPy's reader takes RUA only.

Layout: I. S. Duff, R. G. Grimes, J. G. Lewis, Users' Guide for the Harwell-Boeing Sparse Matrix Collection, 1992.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy.sparse import csc_array, csr_array

from prs_model.arrays import FloatArray, IntArray
from prs_model.errors import PartFileError, short
from prs_model.part_files.text import number, whole_number

from ..tables.mtx import check_end

_FORMAT = re.compile(r"\(\s*(?:\d+P\s*,?\s*)?(\d{0,6})\s*([IEDFG])\s*([1-9]\d{0,2})[^()]*\)", re.IGNORECASE)


def parse_harwell_boeing(text: str, path: Path) -> csr_array:
    """The square matrix of a file, both triangles filled; text: of the file at `path`. Raises PartFileError."""
    check_end(text, path)
    lines = text.splitlines()
    kind = lines[2][:3].upper() if len(lines) > 4 else ""
    if kind not in ("RSA", "RUA"):
        raise PartFileError(
            path, "is neither Matrix Market nor Harwell-Boeing with an assembled real matrix (RSA, RUA)"
        )
    total, *cards = _integers(lines[1], 4, path)[:5]
    right_sides = cards.pop() if len(cards) > 3 else 0
    n, columns, entries = _integers(lines[2][3:], 3, path)[:3]
    if n != columns or entries < 1:
        raise PartFileError(path, f"the matrix is {n}x{columns} with {entries} entries, expected a square one")
    first = 5 if right_sides > 0 else 4
    if len(lines) < first + total or sum(cards) > total:
        raise PartFileError(path, f"has {len(lines)} lines, its heading says {first + total}: cut off")
    forms = lines[3][:16], lines[3][16:32], lines[3][32:52]
    blocks: list[FloatArray] = []
    for form, count, size in zip(forms, cards, (n + 1, entries, entries), strict=True):
        blocks.append(_block(lines[first : first + count], form, size, path))
        first += count
    pointers, rows, data = blocks
    return _matrix(pointers, rows, data, kind == "RSA", path)


def _integers(line: str, count: int, path: Path) -> list[int]:
    words = line.split()
    try:
        found = [whole_number(word) for word in words]
    except ValueError as error:
        raise PartFileError(path, f"heading '{short(line.strip())}': {error}") from error
    if len(found) < count:
        raise PartFileError(path, f"heading '{short(line.strip())}': expected {count} whole numbers")
    return found


def _block(lines: list[str], form: str, size: int, path: Path) -> FloatArray:
    """(size,): numbers with blanks between, else in columns of fixed width, which may touch."""
    found = _FORMAT.search(form)
    if found is None:
        raise PartFileError(path, f"format '{form.strip()}' is not understood, expected such as (10I8) or (3E25.16)")
    width = int(found[3])
    columns = [line.rstrip()[at : at + width] for line in lines for at in range(0, len(line.rstrip()), width)]
    for words in ([word for line in lines for word in line.split()], columns):
        if len(words) == size:
            try:
                return np.array([number(word) for word in words])
            except ValueError as error:
                problem = str(error)
        else:
            problem = f"found {len(words)} numbers, expected {size}"
    raise PartFileError(path, f"block of {form.strip()}: {problem}: damaged")


def _matrix(pointers: FloatArray, rows: FloatArray, data: FloatArray, symmetric: bool, path: Path) -> csr_array:
    n, starts, places = len(pointers) - 1, _whole(pointers, path), _whole(rows, path)
    if starts[0] != 0 or starts[-1] != len(data) or np.any(np.diff(starts) < 0) or np.any((places < 0) | (places >= n)):
        raise PartFileError(path, "its pointers and row numbers are those of no matrix: damaged")
    columns = np.repeat(np.arange(n), np.diff(starts))
    if len(np.unique(columns * n + places)) != len(data):
        raise PartFileError(path, "holds an entry twice: damaged")
    if symmetric and np.any(places < columns) and np.any(places > columns):
        raise PartFileError(path, "says symmetric, but holds entries of both triangles")
    half = csc_array((data, places, starts), shape=(n, n))
    if not symmetric:
        return csr_array(half)
    off = places != columns
    mirrored = csr_array((data[off], (columns[off], places[off])), shape=(n, n))
    return csr_array(half + mirrored)


def _whole(values: FloatArray, path: Path) -> IntArray:
    if np.any(values != np.round(values)):
        raise PartFileError(path, "a pointer or row number is no whole number: damaged")
    return values.astype(np.int64) - 1
