"""Where ANSYS nodes are: an archive (.cdb), a listing of NLIST, or a table exported from Workbench."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.description.units import Units
from prs_model.errors import PartFileError, short
from prs_model.part_files import NodeTable, read_text
from prs_model.part_files.text import number, whole_number

from ..meshes.labelled_mesh import LabelledMesh
from .archive_mesh import mesh_of

LENGTHS = {"UMKS": "um", "CGS": "cm", "BFT": "ft"}
SYSTEMS = {
    name: Units.parse(said)
    for name, said in (("SI", "m-N-kg-s"), ("MKS", "m-N-kg-s"), ("MPA", "mm-N-tonne-s"), ("BIN", "in-lbf-slinch-s"))
}
"""What the command /UNITS calls them; of the others no force or mass has a name here, so only their lengths count."""

_HEADING = re.compile(r"\bX[^\n(]*\((m|mm|cm|um|in|ft)\)", re.IGNORECASE)
_UNITS = re.compile(r"^\s*/UNITS\s*,\s*(\w+)", re.IGNORECASE | re.MULTILINE)
_SYSTEM = re.compile(r"\bDSYS\s*=\s*(\d{1,9})", re.IGNORECASE)
_NUMBER = re.compile(r"\d+\Z")
_FORMAT = re.compile(r"\(([1-9]\d{0,2})i([1-9]\d{0,2}),(\d{1,3})e([1-9]\d{0,2})\.", re.IGNORECASE)
_INTEGERS = re.compile(r"\((\d{1,3})i([1-9]\d{0,2})\)", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class NodeList:
    """Nodes, with their axes where these are rotated; node components of an archive by name; what its units are.

    length: m, mm .. where a heading of Workbench or /UNITS of an archive says it. units: where /UNITS says all of them.
    mesh: of an archive's elements, where matrices can be held against it.
    """

    table: NodeTable
    components: dict[str, tuple[int, ...]]
    length: str | None
    units: Units | None
    mesh: LabelledMesh | None = None

    def check_units(self, said: Units) -> None:
        """Raises PartFileError when the file says others."""
        if self.length not in (None, said.length):
            found = f"is in {self.length}, and 'units' says {said.length}"
        elif self.units is not None and (self.units.force, self.units.mass) != (said.force, said.mass):
            found = f"is in {_words_of(self.units)} (/UNITS), and 'units' says {_words_of(said)}"
        else:
            return
        raise PartFileError(self.table.source, f"{found}: correct one of them, or remove the unit there")


def read_nodes(path: Path) -> NodeList:
    """Read a list of nodes; decimal commas are read. Raises PartFileError naming the line that is wrong."""
    text = read_text(path)
    lines = text.splitlines()
    blocks = [at for at, line in enumerate(lines) if line.strip().upper().startswith("NBLOCK")]
    if len(blocks) > 1:
        raise PartFileError(path, f"has {len(blocks)} NBLOCKs, expected one")
    rows = _block(lines, blocks[0], path) if blocks else _listing(lines, path)
    if not rows:
        raise PartFileError(path, "has no nodes, expected lines of node number, x, y and z")
    table = np.array([[*row, 0.0, 0.0, 0.0][:7] for row in rows])
    angles = table[:, 4:]
    frames = np.array([rotated_axes(each) for each in angles]) if np.any(angles) else None
    nodes = NodeTable(path, table[:, 0].astype(np.int64), table[:, 1:4], frames)
    mesh = mesh_of(lines, nodes) if blocks else None
    return NodeList(nodes, _components(lines, len(rows), path), *_units(text), mesh)


def _units(text: str) -> tuple[str | None, Units | None]:
    """Length of ``X-Position (mm)``, or length and all units of /UNITS,MPA."""
    heading, command = _HEADING.search(text), _UNITS.search(text)
    if heading is not None:
        return heading[1].lower(), None
    system = command[1].upper() if command is not None else ""
    units = SYSTEMS.get(system)
    return units.length if units is not None else LENGTHS.get(system), units


def _words_of(units: Units) -> str:
    return f"{units.length}-{units.force}-{units.mass}-s"


def rotated_axes(angles: FloatArray) -> FloatArray:
    """(3, 3) whose columns are a node's axes: turned by THXY about z, then THYZ about x, then THZX about y [deg].

    Each is about an axis that the turns before have moved (ANSYS, commands N and NROTAT): R = Rz Rx Ry.
    """
    turns = []
    for axis, angle in zip((2, 0, 1), np.deg2rad(angles), strict=True):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[first, first] = turn[second, second] = np.cos(angle)
        turn[second, first], turn[first, second] = np.sin(angle), -np.sin(angle)
        turns.append(turn)
    return np.asarray(turns[0] @ turns[1] @ turns[2])


def _listing(lines: list[str], path: Path) -> list[list[float]]:
    """Lines that start with a node number; headings, which may say a coordinate system, and blank lines between pages.

    Words end with blanks, commas or semicolons; a comma within a number is a decimal one.
    """
    rows = []
    for count, line in enumerate(lines, start=1):
        system = _SYSTEM.search(line)
        if system is not None and int(system[1]) != 0:
            what = f"is listed in coordinate system {system[1]}, expected the global one: list it after DSYS,0"
            raise PartFileError(path, f"line {count}: {what}")
        words = [word.strip(",; \t") for word in _split(line)]
        if not words or not _NUMBER.match(words[0]):
            continue
        try:
            row = [number(word) for word in words if word]
        except ValueError as error:
            raise PartFileError(path, f"line {count}, '{short(line.strip())}': {error}") from error
        if len(row) not in (4, 7):
            what = f"found {len(row)} numbers, expected node, x, y, z, and three angles or none"
            raise PartFileError(path, f"line {count}, '{short(line.strip())}': {what}")
        rows.append(row)
    return rows


def _split(line: str) -> list[str]:
    """Between semicolons, else between blanks, else between commas."""
    plain = line.strip()
    return plain.split(";") if ";" in plain else plain.split() if len(plain.split()) > 1 else plain.split(",")


def _block(lines: list[str], start: int, path: Path) -> list[list[float]]:
    """Rows of an NBLOCK: fixed columns after its format line, zeros at the end left out, up to a line N or -1."""
    form = _FORMAT.search(lines[start + 1]) if start + 1 < len(lines) else None
    if form is None:
        raise PartFileError(path, f"line {start + 2}: expected the format of NBLOCK, such as (3i9,6e21.13e3)")
    n, width, _, wide = map(int, form.groups())
    rows: list[list[float]] = []
    for count, line in enumerate(lines[start + 2 :], start=start + 3):
        if line.strip().startswith(("N,", "-1")):
            _check_count(lines[start], len(rows), path)
            return rows
        text = line[n * width :].rstrip()
        values = [text[at : at + wide] for at in range(0, len(text), wide)]
        try:
            numbers = [number(value) if value.strip() else 0.0 for value in values]
            rows.append([float(int(line[:width])), *[*numbers, 0.0, 0.0, 0.0][: max(3, len(numbers))]])
        except ValueError as error:
            raise PartFileError(path, f"line {count}, '{short(line.strip())}': {error}") from error
    raise PartFileError(path, "NBLOCK has no end (N,..,-1): cut off")


def _check_count(head: str, found: int, path: Path) -> None:
    """NBLOCK,NUMFIELD,Solkey,NDMAX,NDSEL: the last is how many there are, where it is written."""
    words = [word.strip() for word in head.split(",")]
    if len(words) > 4 and words[4].isdigit() and words[4].lstrip("0") != str(found):
        raise PartFileError(path, f"NBLOCK holds {found} nodes and says {short(words[4])}: damaged")


def _components(lines: list[str], nodes: int, path: Path) -> dict[str, tuple[int, ...]]:
    """CMBLOCK,NAME,NODE,count: a negative number ends a range that the one before it starts, of at most all nodes."""
    sets: dict[str, tuple[int, ...]] = {}
    for at, line in enumerate(lines):
        words = [word.strip() for word in line.split("!")[0].split(",")]
        if words[0].upper() != "CMBLOCK" or len(words) < 4 or not words[2].upper().startswith("NODE"):
            continue
        form = _INTEGERS.search(lines[at + 1]) if at + 1 < len(lines) else None
        try:
            count = whole_number(words[3]) if form is not None else 0
        except ValueError:
            count = 0
        if form is None or count == 0:
            raise PartFileError(path, f"line {at + 1}: expected CMBLOCK,name,NODE,count and its format")
        found = _integers(lines[at + 2 :], count, int(form[2]), f"CMBLOCK {words[1]}", path)
        sets[words[1]] = _ranges(found, nodes, f"CMBLOCK {words[1]}", path)
    return sets


def _integers(lines: list[str], count: int, width: int, what: str, path: Path) -> list[int]:
    found: list[int] = []
    for line in lines:
        if len(found) >= count:
            break
        try:
            found += [int(line[at : at + width]) for at in range(0, len(line.rstrip()), width)]
        except ValueError as error:
            raise PartFileError(path, f"{what}: '{short(line.strip())}' is no list of nodes") from error
    if len(found) != count:
        raise PartFileError(path, f"{what} holds {len(found)} numbers and says {count}: cut off")
    return found


def _ranges(found: list[int], most: int, what: str, path: Path) -> tuple[int, ...]:
    nodes: list[int] = []
    for each in found:
        if each < 0 and (not nodes or not 0 < -each - nodes[-1] < most):
            raise PartFileError(path, f"{what}: '{each}' ends no range of its nodes: damaged")
        nodes += range(nodes[-1] + 1, -each + 1) if each < 0 else [each]
    return tuple(nodes)
