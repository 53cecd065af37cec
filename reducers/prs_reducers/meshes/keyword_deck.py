"""Keyword decks of Abaqus and CalculiX (.inp): keywords with their parameters and data lines, includes resolved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from prs_model.errors import PartFileError, short
from prs_model.part_files import read_text
from prs_model.part_files.text import number

Fields = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Card:
    """One keyword with what follows it.

    keyword: in capitals, without the star. options: by name in capitals, as spelled. data: line numbers with the
    comma-separated fields. scope: the part, or the instance with nodes of its own, that it stands in; else empty.
    """

    file: Path
    line: int
    keyword: str
    options: Mapping[str, str]
    data: tuple[tuple[int, Fields], ...]
    scope: str = ""

    def option(self, name: str) -> str:
        """A parameter that must be there. Raises PartFileError."""
        if not self.options.get(name):
            raise self.error(self.line, f"*{self.keyword} without {name}=")
        return self.options[name]

    def error(self, line: int, message: str) -> PartFileError:
        """The error for something wrong in a line of it."""
        return PartFileError(self.file, f"line {line}: {message}")

    def whole(self, line: int, field: str) -> int:
        """A field as a whole number. Raises PartFileError."""
        try:
            return int(field)
        except ValueError as error:
            raise self.error(line, f"*{self.keyword}: found '{short(field)}', expected a whole number") from error

    def floats(self, line: int, fields: Fields, count: int) -> list[float]:
        """Fields as `count` numbers, empty or missing ones zero. Raises PartFileError."""
        padded = (*fields, *[""] * (count - len(fields)))[:count]
        return [self._float(line, field) if field else 0.0 for field in padded]

    def _float(self, line: int, field: str) -> float:
        try:
            return number(field)
        except ValueError as error:
            raise self.error(line, f"*{self.keyword}: found '{short(field, 40)}', expected a number") from error


def read_cards(path: Path) -> list[Card]:
    """The cards of a deck and of all it includes, in order. Raises PartFileError, also for a file of another kind."""
    cards = list(_scoped(_cards(path, ())))
    if not any(card.keyword == "NODE" for card in cards):
        raise PartFileError(path, "has no *NODE in it, expected a keyword deck of Abaqus or CalculiX (.inp)")
    return cards


def deck_files(path: Path) -> tuple[Path, ...]:
    """A deck and all the files it includes, as far as they are there."""
    try:
        return tuple(dict.fromkeys((path, *(card.file for card in _cards(path, ())))))
    except PartFileError:
        return (path,)


def _cards(path: Path, within: tuple[Path, ...]) -> Iterator[Card]:
    """within: the decks that include this one, outermost first."""
    for card in _plain_cards(path):
        yield card
        if card.keyword == "INCLUDE":
            name = card.option("INPUT").strip('"')
            inner, around = path.parent / name, (*within, path.resolve())
            if inner.resolve() in around:
                raise card.error(card.line, f"*INCLUDE of {name}, which includes it: a circle")
            if not inner.is_file():
                raise card.error(card.line, f"*INCLUDE of {name}: there is no such file in {path.parent}")
            yield from _cards(inner, around)


def _plain_cards(path: Path) -> Iterator[Card]:
    start, words, data = 0, "", list[tuple[int, Fields]]()
    for place, line in enumerate(read_text(path).splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            if words:
                yield _card(path, start, words, data)
            start, words, data = place, text[1:], []
        elif not words:
            raise PartFileError(path, f"line {place}: found '{short(text, 60)}' before any keyword (*NODE and so on)")
        elif words.endswith(","):
            words += text
        else:
            data.append((place, tuple(field.strip() for field in text.split(","))))
    if words:
        yield _card(path, start, words, data)


def _card(path: Path, line: int, words: str, data: list[tuple[int, Fields]]) -> Card:
    name, *parameters = words.split(",")
    options = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        options[" ".join(key.upper().split())] = value.strip()
    return Card(path, line, " ".join(name.upper().split()), options, tuple(data))


def _scoped(cards: Iterator[Card]) -> Iterator[Card]:
    scope = ""
    for card in cards:
        if card.keyword in ("PART", "INSTANCE"):
            scope = card.options.get("NAME", "")
        elif card.keyword in ("END PART", "END INSTANCE"):
            scope = ""
        yield replace(card, scope=scope)
