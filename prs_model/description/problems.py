"""Collecting what is wrong with a file, entry by entry, each with its line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches

from ..errors import DescriptionError, Problem

Place = tuple[str | int, ...]
"""The way to an entry of a file: keys and list positions, from the outside in."""


def dotted(place: Place) -> str:
    """``("joints", "R", "interfaces", 0)`` as ``joints.R.interfaces[0]``."""
    text = ""
    for step in place:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def line_of(place: Place, lines: Mapping[Place, int | None]) -> int | None:
    """The line of an entry or, where it was not written, of the closest entry around it."""
    for end in range(len(place), -1, -1):
        if place[:end] in lines:
            return lines[place[:end]]
    return None


def closest(name: object, known: Iterable[str]) -> str | None:
    """The shortest known name that begins with `name`, else the one spelt most like it, if one is close.

    Neither case counts, nor an instance's name before a dot.
    """
    spelt = {each.casefold(): each for each in reversed(list(known))}
    for word in (str(name).casefold(), str(name).casefold().rpartition(".")[2]):
        longer = sorted((each for each in spelt if each.startswith(word)), key=len) if len(word) > 2 else []
        for match in (*longer, *get_close_matches(word, spelt, n=1)):
            return spelt[match]
    return None


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """``; did you mean 'x'?`` when one of the known names is close, else nothing."""
    close = closest(name, known)
    return f"; did you mean '{close}'?" if close else ""


def listed(known: Iterable[str], limit: int = 12) -> str:
    """Names for a sentence, cut when there are very many."""
    names = list(known)
    return ", ".join(names[:limit]) + (f" and {len(names) - limit} more" if len(names) > limit else "") or "none"


def not_known(what: str, name: object, known: Iterable[str]) -> str:
    """The sentence for a name that refers to nothing."""
    names = list(known)
    return f"found '{name}', expected {what} ({listed(names)}){did_you_mean(name, names)}"


class Problems:
    """What is wrong with one YAML file. One problem per entry: the first one found is the one to mend."""

    def __init__(self, file: str, lines: Mapping[Place, int | None]):
        self.file = file
        self.lines = lines
        self._found: dict[Place, Problem] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, place: Place, message: str) -> None:
        if place not in self._found:
            self._found[place] = Problem(self.file, line_of(place, self.lines), dotted(place), message)

    def touches(self, place: Place) -> bool:
        """Whether something was found at this entry, inside it, or around it."""
        return any(place[: len(other)] == other[: len(place)] for other in self._found)

    def in_file_order(self) -> list[Problem]:
        """The problems by line. What an alias repeats elsewhere is told once, where it is written."""
        once: dict[object, Problem] = {}
        for place, problem in self._found.items():
            once.setdefault((problem.line, place[-1:], problem.message) if problem.line else place, problem)
        return sorted(once.values(), key=lambda problem: problem.line or 0)

    def raise_if_any(self, more: Iterable[Problem] = ()) -> None:
        """Raise DescriptionError with everything found here and in other files."""
        problems = [*self.in_file_order(), *more]
        if problems:
            raise DescriptionError(problems)
