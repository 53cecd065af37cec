"""Nastran bulk data, read strictly: an unreadable field is an error with its line, never a blank or a zero."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from prs_model.errors import PartFileError, short
from prs_model.part_files import read_text
from prs_model.part_files.text import number

from .notes import check_sum

NAME = re.compile(r"[A-Z][A-Z0-9]{2,7}\*?")  # no bulk data entry has a shorter name
BULK = re.compile(r"^[ \t]*BEGIN[ \t]+BULK\b", re.MULTILINE | re.IGNORECASE)
WIDTHS = {"small": 8, "large": 16}
BLANK = ""


@dataclass(frozen=True)
class Card:
    """One bulk data entry: its name, and its fields as text, blank ones included, eight or four to a line."""

    path: Path
    line: int
    name: str
    fields: tuple[str, ...]

    def wrong(self, message: str) -> PartFileError:
        """The error to raise for this card."""
        return PartFileError(self.path, f"line {self.line}, {self.name}: {message}")

    def text(self, index: int) -> str:
        """The field at `index`, blank beyond the last."""
        return self.fields[index] if index < len(self.fields) else BLANK

    def integer(self, index: int, default: int | None = None) -> int:
        """An integer field; `default` where it is blank. Raises PartFileError."""
        found = self.text(index)
        if found == BLANK and default is not None:
            return default
        if not re.fullmatch(r"[+-]?\d{1,18}", found):
            raise self.wrong(f"field {index + 2} is '{short(found, 20)}', expected an integer")
        return int(found)

    def real(self, index: int, default: float | None = None) -> float:
        """A real field; `default` where it is blank. Raises PartFileError."""
        found = self.text(index)
        if found == BLANK and default is not None:
            return default
        try:
            value = number(found)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.wrong(f"field {index + 2} is '{short(found, 20)}', expected a finite number")
        return value


def read_cards(path: Path) -> list[Card]:
    """Every entry of a bulk data or punch file, in its order; what stands before BEGIN BULK is left out.

    Raises PartFileError naming the line of what is no bulk data, and for INCLUDE, which is not followed; of a file
    that this program wrote, also where it is not as it was written.
    """
    text = read_text(path)
    check_sum(path, text)
    cards: list[Card] = []
    for line, name, fields in _entries(path, text):
        if name == "BEGIN" and fields == ("BULK",):
            cards.clear()
        elif name == "ENDDATA":
            break
        elif name is not None:
            cards.append(Card(path, line, name, fields))
        else:
            last = cards.pop() if cards else None
            if last is None or last.name == "BEGIN":
                raise PartFileError(path, f"line {line} continues no entry: no bulk data, perhaps a punch of results")
            cards.append(Card(path, last.line, last.name, last.fields + fields))
    return [card for card in cards if card.name != "BEGIN"]


def _entries(path: Path, text: str) -> Iterator[tuple[int, str | None, tuple[str, ...]]]:
    """Line, name (None of a continuation) and fields of every line that holds any."""
    started = BULK.search(text) is None
    kind = ""
    for line, raw in enumerate(text.splitlines(), 1):
        content = raw.split("$")[0].rstrip().expandtabs(8)
        words = tuple(content.upper().replace("=", " ").split())
        if words[:1] == ("BEGIN",):
            started, kind = started or words[1:2] == ("BULK",), ""
            yield line, "BEGIN", words[1:]
        elif words and started:
            if content[0] not in " +*,":
                kind = _kind(content)
                yield line, _name(path, line, content, kind), _fields(path, line, content, kind)
            elif kind and _kind(content) != kind:
                raise PartFileError(path, f"line {line}: a {_kind(content)}-field line continues a {kind}-field entry")
            else:
                yield line, None, _fields(path, line, content, _kind(content))


def _name(path: Path, line: int, content: str, kind: str) -> str:
    name = (content.split(",")[0] if kind == "free" else content[:8]).strip().upper()
    if content.upper().startswith("INCLUDE"):
        raise PartFileError(path, f"line {line}: INCLUDE is not followed: put the entries into one file")
    if not NAME.fullmatch(name):
        raise PartFileError(path, f"line {line}: found '{short(content, 30)}', expected a bulk data entry")
    return name.rstrip("*")


def _kind(content: str) -> str:
    if "," in content:
        return "free"
    return "large" if content[0] == "*" or content[:8].rstrip().endswith("*") else "small"


def _fields(path: Path, line: int, content: str, kind: str) -> tuple[str, ...]:
    if kind == "free":
        return _free_fields(path, line, content)
    width = WIDTHS[kind]
    return tuple(content[at : at + width].strip() for at in range(8, 72, width))


def _free_fields(path: Path, line: int, content: str) -> tuple[str, ...]:
    """Eight fields, or four of a ``*`` line; behind them nothing but the mark of a continuation."""
    name, *found = (each.strip() for each in content.split(","))
    per_line = 4 if "*" in name else 8
    beyond = [each for each in found[per_line:] if each]
    if beyond and not (found[per_line].startswith(("+", "*")) and len(beyond) == 1):
        raise PartFileError(
            path, f"line {line}: found '{short(beyond[0], 20)}' behind {per_line} fields, expected a line of its own"
        )
    return tuple((found + [BLANK] * per_line)[:per_line])
