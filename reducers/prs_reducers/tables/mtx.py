"""Matrix Market files, read strictly.

SciPy's reader takes 3.0D+01 and 3,5 for 3.0, ignores what follows a number, adds up entries that stand there twice, and
can crash on damaged bytes; so the few rules of the format are kept here.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csr_array

from prs_model.arrays import FloatArray
from prs_model.errors import PartFileError, short
from prs_model.part_files.text import whole_number

from .number_table import read_table

BANNER = "%%matrixmarket"


def is_mtx(text: str) -> bool:
    """Whether a text starts as a Matrix Market file does."""
    return text[: len(BANNER)].lower() == BANNER


def parse_mtx(text: str, path: Path, rows: int | None = None) -> csr_array:
    """The real square matrix of a Matrix Market file, both triangles filled; text: of the file at `path`.

    rows: how many it must have, where that is known. Fortran exponents (1.5D+02) are read. Raises PartFileError when
    the file is not such a one, is cut off or goes on too long, names an entry twice or one outside of the matrix.
    """
    layout, symmetric = _banner(text, path)
    check_end(text, path)
    start, line, sizes = _sizes(text, path, 3 if layout == "coordinate" else 2)
    if sizes[0] != sizes[1]:
        raise PartFileError(path, f"the matrix is {sizes[0]}x{sizes[1]}, expected a square one")
    if rows is not None and sizes[0] != rows:
        raise PartFileError(path, f"the matrix has {sizes[0]} rows, expected {rows}: a file of another part or export")
    n = sizes[0]
    if layout == "array":
        return csr_array(_dense(read_table(text[start:], path, 1, first_line=line)[:, 0], n, symmetric, path))
    entries = read_table(text[start:], path, 3, first_line=line)
    if len(entries) != sizes[2]:
        raise PartFileError(path, f"found {len(entries)} entries, the file says {sizes[2]}: cut off or damaged")
    if rows is None and n > len(entries):
        raise PartFileError(path, f"says {n} rows and holds {len(entries)} entries: damaged")
    return _sparse(entries, n, symmetric, path)


def write_mtx(file: io.TextIOBase, matrix: FloatArray, comment: str) -> None:
    """Write a dense matrix as array of 17 digits; one triangle when it is exactly symmetric."""
    n = len(matrix)
    symmetric = bool(np.array_equal(matrix, matrix.T))
    file.write(f"%%MatrixMarket matrix array real {'symmetric' if symmetric else 'general'}\n% {comment}\n{n} {n}\n")
    for column in range(n):
        np.savetxt(file, matrix[column if symmetric else 0 :, column], fmt="%.16e")


def check_end(text: str, path: Path) -> None:
    """Raises PartFileError when the last line does not end, so that its last number may be cut."""
    if not text.endswith(("\n", "\r")):
        last = short(text.rsplit("\n", 1)[-1].strip())
        raise PartFileError(path, f"ends within its last line, '{last}': cut off? If it is whole, end the line")


def _banner(text: str, path: Path) -> tuple[str, bool]:
    words = text.split("\n", 1)[0].lower().split()
    if not words or words[0] != BANNER:
        raise PartFileError(path, "is no Matrix Market file: its first line does not start with %%MatrixMarket")
    expected = ({"matrix"}, {"coordinate", "array"}, {"real", "integer", "double"}, {"general", "symmetric"})
    if len(words) != 5 or any(word not in known for word, known in zip(words[1:], expected, strict=True)):
        raise PartFileError(
            path, f"is '{' '.join(words[1:])}', expected a matrix, coordinate or array, real, general or symmetric"
        )
    return words[2], words[4] == "symmetric"


def _sizes(text: str, path: Path, count: int) -> tuple[int, int, list[int]]:
    """Where the entries start, in which line, and the numbers of the size line: the first no comment and not blank."""
    start = 0
    for at, line in enumerate(io.StringIO(text), start=1):
        start += len(line)
        words = line.split()
        if not words or words[0].startswith("%"):
            continue
        try:
            sizes = [whole_number(word) for word in words]
        except ValueError as error:
            raise PartFileError(path, f"line {at}, the sizes: {error}") from error
        if len(sizes) != count:
            raise PartFileError(path, f"line {at}: found {len(sizes)} sizes, expected {count}")
        return start, at + 1, sizes
    raise PartFileError(path, "has no size line: cut off")


def _dense(values: FloatArray, n: int, symmetric: bool, path: Path) -> FloatArray:
    expected = n * (n + 1) // 2 if symmetric else n * n
    if len(values) != expected:
        raise PartFileError(path, f"found {len(values)} numbers, expected {expected}: cut off or damaged")
    if not symmetric:
        return values.reshape(n, n).T
    matrix = np.zeros((n, n))
    rows, columns = np.triu_indices(n)
    matrix[columns, rows] = matrix[rows, columns] = values
    return matrix


def _sparse(entries: FloatArray, n: int, symmetric: bool, path: Path) -> csr_array:
    places = entries[:, :2]
    if np.any(places != np.round(places)) or np.any(places < 1) or np.any(places > n):
        at = int(np.argmax(np.any((places != np.round(places)) | (places < 1) | (places > n), axis=1)))
        row, column = places[at]
        raise PartFileError(path, f"entry {at + 1} is at ({row:g}, {column:g}), outside of the {n} rows: damaged")
    rows, columns = (places - 1).astype(np.int64).T
    one_triangle = np.all(rows >= columns) or np.all(rows <= columns)
    off = rows != columns
    if symmetric and not one_triangle:
        raise PartFileError(
            path, "says symmetric, but holds entries of both triangles: 'general' if they are all there"
        )
    if not symmetric and one_triangle and np.any(off):
        raise PartFileError(
            path, "says general, but holds one triangle only: 'symmetric' if the other one is its mirror"
        )
    keys = rows * n + columns
    if len(np.unique(keys)) != len(keys):
        raise PartFileError(path, "holds an entry twice: damaged, or a sum of matrices that is not added up")
    data = entries[:, 2]
    if symmetric:
        rows, columns = np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]])
        data = np.concatenate([data, data[off]])
    return csr_array(coo_array((data, (rows, columns)), shape=(n, n)))
