"""Fortran unformatted records, as OP2 and OP4 files are made of: every length stands before and behind its record."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from prs_model.errors import short

INTEGER = re.compile(r" *-?[0-9]+ *")


@dataclass(frozen=True)
class Block:
    """One data block of an OP2 file: its name, its seven trailing integers, and the chunks of each of its records."""

    name: str
    trailer: tuple[int, ...]
    records: tuple[bytes, ...]


def byte_order(data: bytes, first: tuple[int, ...]) -> str:
    """``<`` or ``>``, by which the first length is one of `first`. Raises ValueError."""
    for order in "<>":
        if len(data) >= 4 and int(np.frombuffer(data, f"{order}i4", 1)[0]) in first:
            return order
    raise ValueError("it does not begin with a Fortran record of the expected length: damaged, or of another kind")


def records(data: bytes, order: str) -> Iterator[memoryview]:
    """Every record. Raises ValueError where a length runs beyond the end or differs from the one behind its record."""
    view, at = memoryview(data), 0
    while at < len(data):
        size = _integer(data, order, at)
        end = at + 4 + size
        if size < 0 or end + 4 > len(data):
            raise ValueError(
                f"the record at byte {at} states {size} bytes, beyond the end of the file: truncated or damaged"
            )
        if _integer(data, order, end) != size:
            raise ValueError(f"the record at byte {at} states {size} bytes, but ends otherwise: damaged")
        yield view[at + 4 : end]
        at = end + 4


def _integer(data: bytes, order: str, at: int) -> int:
    if at + 4 > len(data):
        raise ValueError("it ends within a record: truncated")
    return int(np.frombuffer(data, f"{order}i4", 1, at)[0])


def check_op4(data: bytes) -> None:
    """Raises ValueError unless a binary OP4 file consists of whole matrices, each with all its columns in order."""
    order = byte_order(data, (24, 48))
    stream = records(data, order)
    for header in stream:
        if len(header) not in (24, 48):
            raise ValueError(f"a matrix begins with {len(header)} bytes, expected a header of 24 or 48: damaged")
        word = 4 if len(header) == 24 else 8
        columns, rows, _, kind = map(int, np.frombuffer(header, f"{order}i{word}", 4))
        name = bytes(header[4 * word :]).decode("latin-1").strip()
        if columns < 0 or not 1 <= kind <= 4:
            raise ValueError(f"matrix {name} has {columns} columns of type {kind}: damaged")
        _check_columns(stream, name, columns, abs(rows), order, word)


def check_op4_text(data: bytes) -> None:
    """Raises ValueError unless text begins as an OP4 matrix does: columns, rows, form, type, name."""
    line = data.splitlines()[0].decode("latin-1").rstrip() if data.strip() else ""
    width = 16 if line.endswith("|I16") else 8
    ends = (0, width, 2 * width, 2 * width + 8, 2 * width + 16)
    if not all(INTEGER.fullmatch(line[start:end]) for start, end in pairwise(ends)):
        raise ValueError(
            f"it begins with '{short(line, 40)}', expected a matrix's columns, rows, form, type and name: no OP4"
        )


def _check_columns(stream: Iterator[memoryview], name: str, columns: int, rows: int, order: str, word: int) -> None:
    last = 0
    for record in stream:
        if len(record) < 3 * word:
            raise ValueError(f"matrix {name}: a column of {len(record)} bytes: damaged")
        column, row, words = map(int, np.frombuffer(record, f"{order}i{word}", 3))
        if column == columns + 1:
            return
        if not last < column <= columns or words * word != len(record) - 3 * word or not 0 <= row <= rows:
            raise ValueError(f"matrix {name}: column {column} after column {last} of {columns} cannot be: damaged")
        last = column
    raise ValueError(f"matrix {name} ends after column {last} of {columns}: truncated")


class Tokens:
    """The keys and the data of an OP2 file, one after the other. word: bytes of an integer, 4 or 8."""

    def __init__(self, data: bytes):
        self.order = byte_order(data, (4, 8))
        self.word = int(np.frombuffer(data, f"{self.order}i4", 1)[0])
        self._records = records(data, self.order)
        self._left = len(data)

    def _next(self) -> memoryview | None:
        record = next(self._records, None)
        self._left -= 0 if record is None else len(record) + 8
        return record

    def key(self, *expected: int) -> int:
        """The next key. Raises ValueError when it is none, or none of those expected."""
        record = self._next()
        if record is None:
            raise ValueError("it ends without its end mark: truncated")
        found = int(self.integers(record)[0]) if len(record) == self.word else None
        if found is None or (expected and found not in expected):
            raise ValueError(f"found key {found}, expected {' or '.join(map(str, expected)) or 'one'}: damaged")
        return found

    def words(self, count: int) -> bytes:
        """The next data, of `count` words. Raises ValueError when there are more or fewer."""
        data = self.data()
        if len(data) != self.word * count:
            raise ValueError(f"found {len(data)} bytes, expected {self.word * count}: damaged")
        return data

    def data(self) -> bytes:
        """The next data, of any length. Raises ValueError when there are none."""
        record = self._next()
        if record is None:
            raise ValueError("it ends where data should follow: truncated")
        return bytes(record)

    def integers(self, data: bytes | memoryview) -> NDArray[np.int64]:
        """(n,) the words of some data."""
        return np.frombuffer(data, f"{self.order}i{self.word}").astype(np.int64)

    def text(self, data: bytes) -> str:
        """The text in some data, four letters to a word."""
        letters = b"".join(data[at : at + 4] for at in range(0, len(data), self.word))
        return letters.decode("latin-1").strip()

    def at_end(self) -> bool:
        """Whether nothing is left."""
        return self._left == 0


def op2_blocks(tokens: Tokens) -> Iterator[Block]:
    """Every data block of an OP2 file. Raises ValueError where its structure breaks off.

    The structure is that of MSC's and Siemens' OUTPUT2 module, and holds for the OP2 files that pyyeti is tested with.
    """
    key = tokens.key(2, 3)
    if key == 3:  # date, version and label of the run
        tokens.words(key)
        tokens.words(tokens.key(7))
        tokens.words(tokens.key(2))
        tokens.key(-1)
        tokens.key(0)
        key = tokens.key(0, 2)
    while key == 2:
        yield _block(tokens)
        if tokens.at_end():  # some writers leave the end mark out
            return
        key = tokens.key(0, 2)
    if not tokens.at_end():
        raise ValueError("it goes on behind its end mark: damaged")


def _block(tokens: Tokens) -> Block:
    """A block after its first key: name, trailer, and records -2, -3, .. until a key of zero."""
    name = tokens.text(tokens.words(2))
    tokens.key(-1)
    trailer = tuple(map(int, tokens.integers(tokens.words(tokens.key(7)))))
    found: list[bytes] = []
    number = tokens.key(-2)
    while True:
        tokens.key(1)
        is_column = tokens.key() != 0  # of a matrix: its key counts numbers of 4 or 8 bytes
        chunks = []
        while (key := tokens.key()) > 0:
            chunks.append(tokens.data() if is_column else tokens.words(key))
        if key == 0:
            return Block(name, trailer, tuple(found))
        if key != number - 1:
            raise ValueError(f"data block {name}: record {key} after {number}: damaged")
        found.append(b"".join(chunks))
        number = key
