"""The part of a BACON data file (.dat) that tells where nodes are and which groups they form.

Commands start with a point, RETURN ends them. Read are `.NOE`, `.SEL` and `.UNIT`; everything else is passed over.
There is no public manual: of `.NOE` and `.SEL` is accepted what public writers and readers of such files use (CalculiX
cgx, BasicTools), and whatever else stands there is refused with its line. Of `.UNIT` nothing public tells the words:
SI, or a length and a mass (MM and T, M and KG) are taken; anything else leaves the units to be said.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prs_model.description.units import Units
from prs_model.errors import PartFileError, short
from prs_model.part_files import NodeTable, read_text
from prs_model.part_files.text import number

CONTINUED = ("$", "&")
NODES, ELEMENTS = ("NOEUD", "NOEUDS", "NODE", "NODES"), ("MAILLE", "MAILLES", "ELEMENT", "ELEMENTS")
LENGTHS = {"M": "m", "MM": "mm", "METRE": "m", "METER": "m", "MILLIMETRE": "mm", "MILLIMETER": "mm"}
MASSES = {"KG": "kg", "T": "tonne", "TON": "tonne", "TONNE": "tonne"}
SYSTEMS = {("m", "kg"): "m-N-kg-s", ("mm", "tonne"): "mm-N-tonne-s"}

_COMMAND = re.compile(r"\.\d?[A-Za-z]{2}")  # .NOE, and such as .3DRO; but .3, .3E5 are numbers
_WORD = re.compile(r'"([^"]*)"|([^\s"=,]+)')

Line = tuple[int, list[str]]


@dataclass(frozen=True, eq=False)
class Deck:
    """nodes: all of the file, None without `.NOE`. groups: node labels by name. units: as `.UNIT` says, else None.

    units_line: the `.UNIT` command as it stands, which may be one that is not understood.
    """

    source: Path
    nodes: NodeTable | None
    groups: Mapping[str, tuple[int, ...]]
    units: Units | None
    units_line: str


def read_deck(path: Path) -> Deck:
    """Read a deck. Raises PartFileError naming the line that is wrong."""
    commands = list(_commands(read_text(path)))
    if not commands:
        raise PartFileError(path, "has no command (a line that starts with a point): no BACON data file")
    nodes: dict[int, tuple[float, float, float]] = {}
    groups: dict[str, tuple[int, ...]] = {}
    units: list[str] = []
    for name, lines in sorted(commands, key=lambda command: command[0] != ".NOE"):
        try:
            if name == ".NOE":
                _nodes(lines, nodes)
            elif name == ".SEL":
                _groups(lines, groups, nodes)
            elif name == ".UNIT":
                units += [word for _, words in lines for word in words]
        except _LineError as error:
            raise PartFileError(path, f"line {error.line}, {name}: {error}") from error
    table = None
    if nodes:
        table = NodeTable(path, np.array(list(nodes), dtype=np.int64), np.array(list(nodes.values())))
    return Deck(path, table, groups, _units(units), short(" ".join(units)))


class _LineError(Exception):
    """Something that is not understood in a line."""

    def __init__(self, line: int, message: str):
        self.line = line
        super().__init__(message)


def _commands(text: str) -> Iterator[tuple[str, list[Line]]]:
    """Each command with its lines of words, without comments (!), continued ones ($, & at the end) joined.

    Names keep their quotes. A command never continues the line before it.
    """
    name, lines, joins = "", list[Line](), False
    for count, raw in enumerate(text.splitlines(), start=1):
        words = [f'"{quoted}' if quoted else plain for quoted, plain in _WORD.findall(raw.split("!")[0])]
        if not words:
            continue
        continued = words[-1] in CONTINUED
        words = [word for word in words if word not in CONTINUED]
        if words == ["RETURN"]:
            break
        if words and _COMMAND.match(words[0]):
            if name:
                yield name, lines
            name, lines, joins = words[0].upper(), [], False
            words = words[1:]
        if joins and lines:
            lines[-1][1].extend(words)
        elif words:
            lines.append((count, words))
        joins = continued
    if name:
        yield name, lines


def _nodes(lines: list[Line], nodes: dict[int, tuple[float, float, float]]) -> None:
    """``I 12 X 1.32 Y -0.23 Z 0. ATT 1``, several to a line, or ``12 1.32 -0.23 0.``."""
    for line, words in lines:
        if words[0].upper() == "I":
            starts = [at for at, word in enumerate(words) if word.upper() == "I"]
            for start, end in zip(starts, [*starts[1:], len(words)], strict=True):
                entry = _pairs(words[start:end], line)
                _keep(entry.pop("I"), [entry.get(axis, "") for axis in "XYZ"], line, nodes)
        elif len(words) == 4:
            _keep(words[0], words[1:], line, nodes)
        else:
            raise _LineError(line, f"found '{short(' '.join(words))}', expected I n X x Y y Z z, or n x y z")


def _pairs(words: list[str], line: int) -> dict[str, str]:
    keys = [word.upper() for word in words[::2]]
    unknown = [key for key in keys if key not in ("I", "X", "Y", "Z", "ATT")]
    if len(words) % 2 or unknown or len(set(keys)) != len(keys):
        raise _LineError(line, f"found '{short(' '.join(words))}', expected I n X x Y y Z z; write generated nodes out")
    return dict(zip(keys, words[1::2], strict=True))


def _keep(label: str, place: list[str], line: int, nodes: dict[int, tuple[float, float, float]]) -> None:
    try:
        node = _label(label, line)
        x, y, z = (number(value) for value in place)
    except ValueError as error:
        raise _LineError(line, f"node {label}: {error}; X, Y and Z must all be there") from error
    if node in nodes:
        raise _LineError(line, f"node {node} stands there twice")
    nodes[node] = (x, y, z)


def _label(word: str, line: int) -> int:
    if not (word.isascii() and word.isdigit()):
        raise _LineError(line, f"found '{short(word)}', expected a node number; write ranges out")
    return int(word)


def _groups(lines: list[Line], groups: dict[str, tuple[int, ...]], nodes: Mapping[int, object]) -> None:
    """``GROUP 1 NOEUDS NOM "BORE"`` and lines ``I 11 12 13``; groups of elements are passed over."""
    name, of_nodes, whole = "", False, False
    found: list[int] = []

    def close(line: int) -> None:
        if name and of_nodes:
            if name in groups:
                raise _LineError(line, f"a second group '{name}'")
            groups[name] = tuple(nodes) if whole else tuple(dict.fromkeys(found))

    last = 0
    for last, words in lines:
        if words[0].upper() in ("GROUP", "GROUPE"):
            close(last)
            name, of_nodes, whole = _heading(words, last)
            found = []
        elif not name:
            raise _LineError(last, f"found '{short(' '.join(words))}', expected GROUP number NOEUDS NOM \"name\"")
        elif of_nodes:
            found += [_label(word, last) for word in words if word.upper() != "I"]
    close(last)


def _heading(words: list[str], line: int) -> tuple[str, bool, bool]:
    """Name (its number without one), whether it is of nodes, and whether of all of them."""
    name, kinds, whole, given = "", set[bool](), False, iter(words[1:])
    for word in given:
        plain = word.upper()
        if plain == "NOM":
            name = next(given, "").strip('"')
        elif word.startswith('"'):
            name = word.strip('"')
        elif plain in NODES or plain in ELEMENTS:
            kinds.add(plain in NODES)
        elif plain == "TOUT":
            whole = True
        elif word.isdigit():
            name = name or word
        else:
            raise _LineError(line, f"found '{short(word)}', expected number, NOM \"name\", NOEUDS, MAILLES or TOUT")
    if not name or len(kinds) != 1:
        raise _LineError(line, 'expected a number or NOM "name", and NOEUDS or MAILLES')
    return name, kinds.pop(), whole


def _units(words: list[str]) -> Units | None:
    """SI, or a length and a mass that go together; None for anything else."""
    plain = [word.strip('"').upper() for word in words]
    if "SI" in plain:
        return Units()
    lengths = {LENGTHS[word] for word in plain if word in LENGTHS}
    masses = {MASSES[word] for word in plain if word in MASSES}
    if len(lengths) != 1 or len(masses) != 1:
        return None
    system = SYSTEMS.get((lengths.pop(), masses.pop()))
    return None if system is None else Units.parse(system)
