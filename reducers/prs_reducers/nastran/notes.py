"""What this program leaves in comments of the bulk data that it writes: a sum of the lines, units, names of points."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from prs_model.description.units import Units
from prs_model.errors import PartFileError, short
from prs_model.part_files import read_text

SIGNED = "$ Written by prs-model, with a sum of its lines at the end"
SUM = re.compile(r"^\$ prs-model sum ([0-9a-f]{16})\s*$", re.MULTILINE)
NOTE = re.compile(r"^\$ prs-model (units|point) (.*)$", re.MULTILINE)
POINT = re.compile(r'(\d{1,8}) = (".*")')


@dataclass(frozen=True)
class Notes:
    """names: of points that have one beside their number. units: of the file, None where it does not say them."""

    names: Mapping[int, str]
    units: Units | None


def notes_of(path: Path) -> Notes:
    """What stands in the comments of a file. Raises PartFileError for a note that is not as it was written."""
    names: dict[int, str] = {}
    units = None
    for found in NOTE.finditer(read_text(path)):
        kind, said = found[1], found[2].strip()
        try:
            if kind == "units":
                units = Units.parse(said)
            else:
                number, name = _point(said)
                names[number] = name
        except ValueError as error:
            raise PartFileError(path, f"comment '{short(found[0].strip(), 60)}' is damaged: {error}") from error
    return Notes(names, units)


def note_lines(units: Units, names: Mapping[int, str], *, grounded: bool) -> list[str]:
    """Comments that `notes_of` understands, and one for the reader."""
    held = ["$ held to the ground: say 'grounded: true'"] if grounded else []
    named = [f"$ prs-model point {number} = {json.dumps(name)}" for number, name in names.items()]
    return [f"$ prs-model units {system(units)}", *held, *named]


def system(units: Units) -> str:
    """Units as one word, such as ``mm-N-tonne-s``."""
    return f"{units.length}-{units.force}-{units.mass}-s"


def signed(lines: list[str]) -> bytes:
    """Lines as a file whose last line is their sum, by which damage is noticed that no format shows."""
    lines = [SIGNED, *lines]
    return "\n".join([*lines, f"$ prs-model sum {_sum(lines)}", ""]).encode("ascii")


def check_sum(path: Path, text: str) -> None:
    """Raises PartFileError for a file of this program that is not as it was written."""
    found = SUM.search(text)
    whole = not text[found.end() :].strip() and _sum(text[: found.start()].splitlines()) == found[1] if found else False
    if (found or SIGNED in text) and not whole:
        hint = "it is damaged, or was edited (remove its first and last line if that was meant)"
        raise PartFileError(path, f"is not as it was written: {hint}")


def _sum(lines: list[str]) -> str:
    return hashlib.sha256("\n".join(lines).encode("latin-1")).hexdigest()[:16]


def _point(text: str) -> tuple[int, str]:
    """Raises ValueError."""
    found = POINT.fullmatch(text)
    name = json.loads(found[2]) if found else None
    if found is None or not isinstance(name, str):
        raise ValueError("expected a point's number and its name in quotes")
    return int(found[1]), name
