"""The table that says what each row of a pair of matrices stands for: a text file anybody can write.

    # units: mm-N-tonne-s
    row  node  component     x     y     z
      1    11         ux   0.0  20.0  30.0
      2    11         uy   0.0  20.0  30.0
      7     1       mode

Words are separated by blanks, tabs, commas or semicolons; names with blanks stand in double quotes. Rows are numbered
from 1. A component is ux, uy, uz, rx, ry, rz or 1..6, and `mode` for a modal coordinate, whose node is its number. The
heading and the coordinates may be absent. Lines that start with #, % or ! are comments; of these are understood

    # units: mm-N-tonne-s          what the numbers are in; the reader need not be told then, and not otherwise
    # reduced: true                a condensed part, though no modes are among its rows
    # modes: fixed-interface       the modes are mass-normalised and uncoupled from the nodes by stiffness
    # set bore: 11 12 13           a named set of nodes
    # stiffness-sha256: 6a1f..     what the file of the stiffness must hash to; mass-sha256 likewise
"""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.problems import closest
from prs_model.description.units import Units
from prs_model.errors import PartFileError, short
from prs_model.part_files import MODE, NodeTable, read_text
from prs_model.part_files.text import number, whole_number
from prs_model.reduction.super_element import AXES

from .mtx import check_end

logger = logging.getLogger("prs_model")

COMMENTS = ("#", "%", "!")
HEADING = ("row", "node", "component", "x", "y", "z")
COMPONENTS = {
    **{name: index for index, name in enumerate(AXES)},
    **{str(index + 1): index for index in range(6)},
    **{f"rot{axis}": 3 + index for index, axis in enumerate("xyz")},
}

_WORD = re.compile(r'"([^"]*)"|([^\s,;"]+)')
FACTS = ("units", "reduced", "modes", "stiffness-sha256", "mass-sha256")
_FACT = re.compile(rf"[#%!]\s*({'|'.join(FACTS)}|set\s+(.+?))\s*:\s*(.*\S)\s*$", re.IGNORECASE)
_REMARK = re.compile(r"[#%!]\s*([\w-]+)(\s+\S+)?\s*:\s*\S")


@dataclass(frozen=True, eq=False)
class DofTable:
    """What each row is. nodes: (n,) labels, of a mode its number; components: (n,) 0..5 or MODE.

    places: where the nodes are, None when the table has no coordinates. facts: `units`, `reduced` and the others as
    they stand in comments; node_sets: node labels by name.
    """

    source: Path
    nodes: NDArray[np.str_]
    components: IntArray
    places: NodeTable | None
    facts: Mapping[str, str] = field(default_factory=dict)
    node_sets: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def has_modes(self) -> bool:
        return bool(np.any(self.components == MODE))

    @property
    def is_reduced(self) -> bool:
        """Whether modes are among the rows, or a comment says that the part is condensed."""
        return self.has_modes or self.facts.get("reduced") == "true"

    @property
    def modes(self) -> str:
        """What is promised of the modes: fixed-interface, or nothing."""
        return self.facts.get("modes", "")

    def units(self, said: Units | None) -> Units | None:
        """What the table says, else what was said besides. Raises PartFileError when these differ."""
        if "units" not in self.facts:
            return said
        try:
            written = Units.parse(self.facts["units"])
        except ValueError as error:
            raise PartFileError(self.source, f"units: {error}") from error
        if said not in (None, written):
            found = f"{said.length}-{said.force}-{said.mass}-s"
            other = f"is in {self.facts['units']}, and 'units' says {found}: correct one of them"
            raise PartFileError(self.source, other)
        return written

    def check_digest(self, name: str, text: str, path: Path) -> None:
        """Raises PartFileError when the text of the file of `name` is not the one that the table was written with."""
        said = self.facts.get(f"{name}-sha256", digest(text))
        if said != digest(text):
            raise PartFileError(
                path,
                f"is not the {name} that {self.source.name} was written with: changed, damaged or of another part; if "
                f"that is meant, remove the line '{name}-sha256' there",
            )


def digest(text: str) -> str:
    """Of the lines of a text, whatever ends them."""
    return sha256("\n".join(text.splitlines()).encode("latin-1", "replace")).hexdigest()


def read_dof_table(path: Path) -> DofTable:
    """Read a table. Raises PartFileError naming the line that is wrong, or the row that is missing or named twice."""
    facts: dict[str, str] = {}
    sets: dict[str, tuple[str, ...]] = {}
    rows: dict[int, tuple[str, int]] = {}
    places: dict[str, FloatArray] = {}
    placed: set[bool] = set()
    text = read_text(path)
    check_end(text, path)
    for count, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if line.startswith(COMMENTS):
            _fact(line, facts, sets, path)
            continue
        words = [quoted or plain for quoted, plain in _WORD.findall(line)]
        if not words or (not rows and _is_heading(words)):
            continue
        try:
            row, node, component, place = _row(words)
            if row in rows:
                raise ValueError(f"row {row} stands there twice")
            rows[row] = node, component
            if component != MODE:
                placed.add(place is not None)
                _keep(node, place, places)
        except ValueError as error:
            raise PartFileError(path, f"line {count}, '{short(line)}': {error}") from error
    _check_rows(rows, path)
    _check_facts(facts, path)
    if len(placed) > 1:
        raise PartFileError(path, "some rows have coordinates and some have none: give them for all, or for none")
    nodes, components = zip(*(rows[row] for row in sorted(rows)), strict=True)
    table = NodeTable(path, np.array(list(places)), np.array(list(places.values()))) if places else None
    return DofTable(path, np.array(nodes), np.array(components, dtype=np.int64), table, facts, sets)


def write_dof_table(
    table: DofTable, units: str, positions: Mapping[str, FloatArray], remarks: tuple[str, ...] = ()
) -> str:
    """The text of a table whose node positions are in `units`, 17 digits."""
    facts = {"units": units, **table.facts}
    lines = [f"# {remark}" for remark in remarks]
    lines += [f"# {name}: {value}" for name, value in facts.items()]
    lines += [f"# set {name}: {' '.join(map(_quoted, nodes))}" for name, nodes in table.node_sets.items()]
    lines.append("# row node component x y z")
    for row, (node, component) in enumerate(zip(table.nodes.tolist(), table.components.tolist(), strict=True), start=1):
        if component == MODE:
            lines.append(f"{row} {_quoted(node)} mode")
        else:
            place = " ".join(f"{value:.16e}" for value in positions[node])
            lines.append(f"{row} {_quoted(node)} {AXES[component]} {place}")
    return "\n".join(lines) + "\n"


def _fact(line: str, facts: dict[str, str], sets: dict[str, tuple[str, ...]], path: Path) -> None:
    found = _FACT.match(line)
    if found is None:
        _warn_of_near_fact(line, path)
        return
    name, set_name, value = found.groups()
    if set_name is not None:
        sets[set_name.strip()] = tuple(quoted or plain for quoted, plain in _WORD.findall(value))
    else:
        facts[name.lower()] = value


def _warn_of_near_fact(line: str, path: Path) -> None:
    remark = _REMARK.match(line)
    near = closest(remark[1].lower(), (*FACTS[:3], "set")) if remark is not None else None
    if near is not None:
        logger.warning("%s: the comment '%s' says nothing here; did you mean '%s'?", path.name, short(line, 60), near)


def _check_facts(facts: Mapping[str, str], path: Path) -> None:
    known = {"reduced": ("true", "false"), "modes": ("fixed-interface",)}
    for name, values in known.items():
        if facts.get(name, values[0]) not in values:
            raise PartFileError(path, f"comment '{name}': found '{facts[name]}', expected {' or '.join(values)}")


def _is_heading(words: list[str]) -> bool:
    return tuple(word.lower() for word in words) in (HEADING, HEADING[:3])


def _row(words: list[str]) -> tuple[int, str, int, FloatArray | None]:
    """Row, node, component and coordinates. Raises ValueError."""
    row = whole_number(words[0])
    if row < 1:
        raise ValueError("found row 0, expected rows from 1 on")
    if len(words) > 1 and words[-1].lower() == "mode" and len(words) <= 3:
        return row, words[1] if len(words) == 3 else words[0], MODE, None
    if len(words) not in (3, 6):
        raise ValueError(
            f"found {len(words)} words, expected row, node and component, then x, y, z or nothing (with decimal points)"
        )
    component = COMPONENTS.get(words[2].lower())
    if component is None:
        raise ValueError(f"found component '{words[2]}', expected ux, uy, uz, rx, ry, rz, 1..6 or mode")
    return row, words[1], component, np.array([number(word) for word in words[3:]]) if len(words) == 6 else None


def _keep(node: str, place: FloatArray | None, places: dict[str, FloatArray]) -> None:
    """The rows of one node repeat its coordinates, so they must agree."""
    if place is not None and np.any(places.setdefault(node, place) != place):
        raise ValueError(f"node {node} was at {_listed(places[node])} before: rows or coordinates are mixed up")


def _listed(place: FloatArray) -> str:
    return " ".join(f"{value:g}" for value in place)


def _check_rows(rows: Mapping[int, object], path: Path) -> None:
    if not rows:
        raise PartFileError(path, "has no rows, expected lines such as '1 11 ux 0.0 20.0 30.0'")
    missing = sorted(set(range(1, max(rows) + 1)) - set(rows))[:5] if max(rows) < 10 * len(rows) else [len(rows) + 1]
    if missing:
        raise PartFileError(path, f"row {missing[0]} is missing, and rows go up to {max(rows)}")


def _quoted(name: str) -> str:
    return name if _WORD.fullmatch(name) and not name.startswith('"') else f'"{name}"'
