"""Text files of solvers: plain or gzipped, read whole, with a clear word about what is no text."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from ..errors import PartFileError, short

MOST_DIGITS = 15  # of a whole number; more are none of a file's counts and labels
LARGEST_EXPANSION = 200  # times the size of a .gz file: text of numbers packs ten to thirty times
_NO_LETTER = re.compile(r"([-+]?\d*\.\d*)([-+]\d{1,3})")  # 1.5-102, as Fortran writes exponents of three digits


def read_text(path: Path) -> str:
    """The text of a file, unpacked where it is gzipped.

    Raises PartFileError when there is no such file, it cannot be read or unpacked, is empty, or is no text.
    """
    data = read_bytes(path)
    if b"\0" in data[:65536]:
        raise PartFileError(path, "is a binary file, expected text")
    if not data.strip():
        raise PartFileError(path, "is empty")
    return data.decode("latin-1")


def read_bytes(path: Path) -> bytes:
    """The content of a file, unpacked where it is gzipped. Raises PartFileError."""
    with file_access(path, "read"):
        data = path.read_bytes()
    if data[:2] != b"\x1f\x8b":
        return data
    limit = LARGEST_EXPANSION * len(data)
    try:
        with gzip.open(path) as packed:
            text = packed.read(limit + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise PartFileError(path, f"cannot be unpacked ({error}): truncated or damaged") from error
    if len(text) > limit:
        raise PartFileError(path, f"unpacks to more than {LARGEST_EXPANSION} times its size: damaged")
    return text


@contextmanager
def file_access(path: Path, purpose: Literal["read", "written"]) -> Iterator[None]:
    """Around what opens a file: PartFileError instead of OSError."""
    try:
        yield
    except OSError as error:
        if purpose == "read" and isinstance(error, FileNotFoundError):
            raise PartFileError(path, "there is no such file") from error
        raise PartFileError(path, f"cannot be {purpose}: {error.strerror or error}") from error


def number(text: str) -> float:
    """A number as solvers write it: 1.5, 1.5D+02, 1.5+02 (Fortran), 1,5 (decimal comma). Raises ValueError."""
    plain = text.strip().replace(",", ".").replace("D", "E").replace("d", "e")
    fortran = _NO_LETTER.fullmatch(plain)
    try:
        if "_" in plain:  # which Python allows within a number
            raise ValueError
        return float(f"{fortran[1]}e{fortran[2]}" if fortran else plain)
    except ValueError:
        raise ValueError(f"found '{short(text)}', expected a number") from None


def whole_number(text: str) -> int:
    """Plain digits without a sign, as counts and labels are. Raises ValueError."""
    if not (text.isascii() and text.isdigit() and len(text) <= MOST_DIGITS):
        raise ValueError(f"found '{short(text)}', expected a whole number")
    return int(text)
