"""Ways in which part files are damaged, each the same in every run."""

from __future__ import annotations

import gzip
import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

ANOTHER_KIND = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x10\0\0\0\x10\x08\x02\0\0\0\x90\x91h6" + bytes(range(256))
PROSE = b"Dear colleague,\n\nattached is the part you asked for. It weighs about 12 kg.\n\nKind regards\n"
GARBAGE = b"\n\xff\xfe 17 garbage \x07\n 1 2 3\n"

LEADING_DIGIT = re.compile(rb"(?<![0-9.eEdD])(?<![eEdD][+-])[1-9]")

Change = Callable[[bytes, random.Random], bytes]


@dataclass(frozen=True)
class Variant:
    """One damage to one file's content."""

    name: str
    change: Change

    def __call__(self, content: bytes, file: str) -> bytes:
        return self.change(content, random.Random(f"{file} {self.name}"))


def variants(content: bytes, places: int) -> Iterator[Variant]:
    """What may befall a file of this content; bits, digits and lines are damaged at `places` seeded places."""
    packed = content[:2] == b"\x1f\x8b"
    text = b"\0" not in (gzip.decompress(content) if packed else content)
    yield Variant("empty", lambda data, _: b"")
    for share in (10, 50, 90):
        yield Variant(f"truncated at {share}%", partial(_beginning, share))
    yield Variant("all bytes zero", lambda data, _: bytes(len(data)))
    yield Variant("a picture", lambda data, _: ANOTHER_KIND)
    yield Variant("prose", lambda data, _: PROSE)
    yield Variant("garbage appended", lambda data, _: data + GARBAGE)
    for place in range(1, places + 1):
        yield Variant(f"a bit flipped ({place})", _flip_bit)
    inner = LINES if text else BLOCKS
    for name, change in inner.items():
        count = 1 if name in ONCE else places
        for place in range(1, count + 1):
            said = name if count == 1 else f"{name} ({place})"
            yield Variant(said, _unpacked(change) if packed else change)


def _beginning(share: int, data: bytes, chance: random.Random) -> bytes:
    return data[: len(data) * share // 100]


def _flip_bit(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << chance.randrange(8))]) + data[at + 1 :]


def _another_digit(data: bytes, chance: random.Random) -> bytes:
    at = chance.choice([found.start() for found in LEADING_DIGIT.finditer(data)] or [0])
    digit = chance.choice([byte for byte in b"123456789" if byte != data[at]])
    return data[:at] + bytes([digit]) + data[at + 1 :]


def _end_missing(data: bytes, chance: random.Random) -> bytes:
    return b"".join(_lines(data)[:-1])


def _lines_swapped(data: bytes, chance: random.Random) -> bytes:
    lines = _lines(data)
    if len(lines) < 2:
        return data
    a, b = sorted(chance.sample(range(len(lines)), 2))
    lines[a], lines[b] = lines[b], lines[a]
    return b"".join(lines)


def _neighbours_swapped(data: bytes, chance: random.Random) -> bytes:
    lines = _lines(data)
    if len(lines) < 2:
        return data
    a = chance.randrange(len(lines) - 1)
    lines[a], lines[a + 1] = lines[a + 1], lines[a]
    return b"".join(lines)


def _line_doubled(data: bytes, chance: random.Random) -> bytes:
    lines = _lines(data)
    at = chance.randrange(len(lines))
    return b"".join([*lines[: at + 1], *lines[at:]])


def _line_missing(data: bytes, chance: random.Random) -> bytes:
    lines = _lines(data)
    at = chance.randrange(len(lines))
    return b"".join(lines[:at] + lines[at + 1 :])


def _block_zero(data: bytes, chance: random.Random) -> bytes:
    at = _block(data, chance)
    return data[:at] + bytes(len(data[at : at + BLOCK])) + data[at + BLOCK :]


def _blocks_swapped(data: bytes, chance: random.Random) -> bytes:
    a, b = sorted((_block(data, chance), _block(data, chance)))
    if b - a < BLOCK:
        return _block_missing(data, chance)
    return data[:a] + data[b : b + BLOCK] + data[a + BLOCK : b] + data[a : a + BLOCK] + data[b + BLOCK :]


def _block_doubled(data: bytes, chance: random.Random) -> bytes:
    at = _block(data, chance)
    return data[: at + BLOCK] + data[at:]


def _block_missing(data: bytes, chance: random.Random) -> bytes:
    at = _block(data, chance)
    return data[:at] + data[at + BLOCK :]


def _numbers_huge(data: bytes, chance: random.Random) -> bytes:
    """Eight bytes of ones: a size beyond any memory, or a number that is none."""
    at = _block(data, chance)
    return data[:at] + b"\xff" * 8 + data[at + 8 :]


BLOCK = 64
LINES: dict[str, Change] = {
    "another digit": _another_digit,
    "lines swapped": _lines_swapped,
    "neighbour lines swapped": _neighbours_swapped,
    "a line twice": _line_doubled,
    "a line missing": _line_missing,
    "last line missing": _end_missing,
}
BLOCKS: dict[str, Change] = {
    "64 bytes zero": _block_zero,
    "64 bytes swapped": _blocks_swapped,
    "64 bytes twice": _block_doubled,
    "64 bytes missing": _block_missing,
    "8 bytes of ones": _numbers_huge,
    "last 16 bytes missing": lambda data, _: data[:-16],
}
ONCE = ("last line missing", "last 16 bytes missing")


def _lines(data: bytes) -> list[bytes]:
    return data.splitlines(keepends=True)


def _block(data: bytes, chance: random.Random) -> int:
    """The start of one of the file's pieces of 64 bytes."""
    return BLOCK * chance.randrange(max(1, len(data) // BLOCK))


def _unpacked(change: Change) -> Change:
    return lambda data, chance: gzip.compress(change(gzip.decompress(data), chance), mtime=0)
