"""A part as Simcenter's EXTSEOUT(DMIGOP2) exports it: an OP2 file with a directory XSOP2DIR and EXTDB data blocks.

What the layout is taken from, and how far it was checked:

- The frame of records and data blocks holds for every OP2 file that pyyeti is tested with (MSC, NX, both byte orders).
- The DMIG record (its key 114, 1, 120, then name, form, types, columns, entries, -1 -1) is read by pyyeti and pyNastran
  alike; of pyyeti's ``matrix.op2`` this reader gives the matrices that the punch of the same run has.
- GRID, CORD2x records are those of GEOM1, as in the OP2 files that pyyeti is tested with, and in double precision as
  pyNastran has them (keys 1120001 and 2220008).
- That XSOP2DIR names the EXTDB blocks in their order (GEOM1EX, .., MATK, MATM) is taken from pyNastran's comments on
  a Simcenter 2019.2 file. **No such file was at hand**: one that is laid out otherwise is refused, not guessed at.

Coordinates in single precision have seven digits only, which the physics gate lets pass and a warning names: the bulk
data file has them all (option ``grids``), and so has MATOP4.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np

from prs_model.errors import PartFileError
from prs_model.part_files import LabelledMatrices, NodeTable
from prs_model.part_files.text import file_access

from .dmig import Dmig, labelled
from .fortran import Block, Tokens, op2_blocks
from .geometry import Grid, System, check_points, node_table
from .punch import grid_table

logger = logging.getLogger("prs_model")

T = TypeVar("T", Grid, System)

DIRECTORY, EXTERNAL = "XSOP2DIR", "EXTDB"
DMIG_KEY = (114, 1, 120)
GRID_KEYS = {(4501, 45, 1): "f", (4501, 45, 810001): "f", (4501, 45, 1120001): "d"}
SYSTEM_KEYS = {
    (2101, 21, 8): (1, "f"),
    (2001, 20, 9): (2, "f"),
    (2201, 22, 10): (3, "f"),
    (2101, 21, 2220008): (1, "d"),
    (2001, 20, 2220009): (2, "d"),
    (2201, 22, 2220010): (3, "d"),
}
END = [-1, -1]  # of a column, and of all columns
INSTEAD = "export EXTSEOUT(.., MATOP4) instead"


@dataclass
class External:
    """What is found in the data blocks: matrices by the directory's name, points and coordinate systems.

    coarse: points have places of single precision.
    """

    matrices: dict[str, Dmig] = field(default_factory=dict)
    grids: dict[int, Grid] = field(default_factory=dict)
    systems: dict[int, System] = field(default_factory=dict)
    coarse: bool = False


def is_external(path: Path) -> bool:
    """Whether an OP2 file has EXTDB or DMIG data blocks (one in nas2cam form has not). Raises PartFileError."""
    tokens, blocks = _blocks(path)
    return any(block.name in (DIRECTORY, EXTERNAL) or _has_dmig(block, tokens) for block in blocks)


def read_extdb(path: Path, grids: Path | None, stiffness: str, mass: str) -> tuple[LabelledMatrices, NodeTable]:
    """Stiffness and mass of an EXTSEOUT(DMIGOP2) file. grids: bulk data with its GRID and CORD2 entries, to be used
    instead of those in the file. Raises PartFileError.
    """
    found = external(path)
    matrices, rows = labelled(found.matrices, stiffness, mass, {}, path)
    if grids is not None:
        return matrices, grid_table(path, [], grids, {}, rows)
    if not found.grids:
        raise PartFileError(path, f"it has no GRID record: name a bulk data file with option 'grids', or {INSTEAD}")
    check_points(path, rows, found.grids, None)
    if found.coarse:
        hint = "where that is too coarse, name the bulk data file with option 'grids'"
        logger.warning("%s: its points have places of seven digits (single precision): %s", path.name, hint)
    return matrices, node_table(path, found.grids, found.systems)


def external(path: Path) -> External:
    """Matrices, points and coordinate systems of an OP2 file with EXTDB or DMIG data blocks. Raises PartFileError."""
    tokens, blocks = _blocks(path)
    found = External()
    for name, block in _named(path, blocks, tokens):
        for record in block.records:
            key = tuple(tokens.integers(record[:12]).tolist()) if len(record) > 12 and tokens.word == 4 else ()
            if key == DMIG_KEY:
                if name in found.matrices:
                    raise PartFileError(path, f"it has two matrices {name}: {INSTEAD}")
                found.matrices[name] = _dmig(path, name, record, tokens.order)
            elif key in GRID_KEYS:
                _merge(path, found.grids, _grids(path, record[12:], tokens.order, GRID_KEYS[key]))
                found.coarse |= GRID_KEYS[key] == "f"
            elif key in SYSTEM_KEYS:
                _merge(path, found.systems, _systems(path, record[12:], tokens.order, *SYSTEM_KEYS[key]))
    if not found.matrices:
        raise PartFileError(path, f"it has no DMIG records in words of 4 bytes: {INSTEAD}")
    return found


def _merge(path: Path, found: dict[int, T], more: dict[int, T]) -> None:
    for number in found.keys() & more.keys():
        if found[number] != more[number]:
            raise PartFileError(path, f"{number} stands there twice, with different data: {INSTEAD}")
    found.update(more)


def _blocks(path: Path) -> tuple[Tokens, list[Block]]:
    try:
        with file_access(path, "read"):
            tokens = Tokens(path.read_bytes())
        return tokens, list(op2_blocks(tokens))
    except ValueError as error:
        raise PartFileError(path, f"is no whole OP2 file: {error}") from error


def _has_dmig(block: Block, tokens: Tokens) -> bool:
    head = 3 * tokens.word
    return any(len(each) > head and tuple(tokens.integers(each[:head])) == DMIG_KEY for each in block.records)


def _named(path: Path, blocks: list[Block], tokens: Tokens) -> Iterator[tuple[str, Block]]:
    """Blocks under the names of the directory, which lists itself and all that follow; without one, under their own."""
    listed = [block for block in blocks if block.name == DIRECTORY]
    unnamed = [block for block in blocks if block.name == EXTERNAL]
    if not listed:
        if unnamed:
            raise PartFileError(path, f"it has {EXTERNAL} data blocks but no {DIRECTORY}, which names them: {INSTEAD}")
        yield from ((block.name.upper(), block) for block in blocks)
        return
    names = [tokens.text(record).upper() for record in listed[0].records if len(record) >= 2 * tokens.word]
    names = [name for name in names if name not in (DIRECTORY, "PVT", "PVT0")]
    others = [block for block in blocks if block.name not in (DIRECTORY, "PVT", "PVT0")]
    if len(listed) > 1 or len(names) != len(others):
        raise PartFileError(path, f"{DIRECTORY} names {len(names)} data blocks, but {len(others)} are there: {INSTEAD}")
    yield from zip(names, others, strict=True)


def _dmig(path: Path, name: str, record: bytes, order: str) -> Dmig:
    words = np.frombuffer(record, f"{order}i4").tolist()
    if len(words) < 16 or words[5] != 0:
        raise PartFileError(path, f"the DMIG record of {name} is {len(words)} words long: {INSTEAD}")
    matrix = Dmig(path, name, form=words[6], kind=words[7], columns=words[11])
    number = np.dtype({1: f"{order}f4", 2: f"{order}f8", 3: f"{order}c8", 4: f"{order}c16"}[matrix.kind])
    at, step, last = 12, 2 + number.itemsize // 4, len(words) - 2
    while at < last:
        column, at = (words[at], words[at + 1]), at + 2
        while words[at : at + 2] != END:
            if at + step > last:
                raise PartFileError(
                    path, f"the DMIG record of {name} ends within column {column[0]}.{column[1]}: {INSTEAD}"
                )
            value = np.frombuffer(record, number, 1, 4 * (at + 2))[0]
            matrix.put((words[at], words[at + 1]), column, complex(value))
            at += step
        at += 2
    if words[at:] != END:
        raise PartFileError(path, f"the DMIG record of {name} does not end with its end mark: {INSTEAD}")
    matrix.check()
    return matrix


def _entries(path: Path, data: bytes, layout: np.dtype[np.void], what: str) -> Iterator[np.void]:
    if len(data) % layout.itemsize:
        raise PartFileError(
            path, f"its {what} record is {len(data)} bytes long, expected entries of {layout.itemsize}: {INSTEAD}"
        )
    return iter(np.frombuffer(data, layout))


def _grids(path: Path, data: bytes, order: str, real: str) -> dict[int, Grid]:
    fields = [("id", "i4"), ("cp", "i4"), ("x", _real(real), 3), ("cd", "i4"), ("ps", "i4"), ("seid", "i4")]
    layout = np.dtype([(name, f"{order}{kind}", *size) for name, kind, *size in fields])
    found: dict[int, Grid] = {}
    for each in _entries(path, data, layout, "GRID"):
        x, y, z = map(float, each["x"])
        found[int(each["id"])] = Grid(int(each["cp"]), (x, y, z), int(each["cd"]))
    return found


def _systems(path: Path, data: bytes, order: str, kind: int, real: str) -> dict[int, System]:
    layout = np.dtype([("head", f"{order}i4", 4), ("x", f"{order}{_real(real)}", (3, 3))])
    found: dict[int, System] = {}
    for each in _entries(path, data, layout, "CORD2"):
        number, stated, _, parent = map(int, each["head"])
        if stated != kind:
            raise PartFileError(path, f"coordinate system {number} states type {stated}, expected {kind}: {INSTEAD}")
        a, b, c = ((float(x), float(y), float(z)) for x, y, z in each["x"])
        found[number] = System(kind, parent, (a, b, c))
    return found


def _real(kind: str) -> str:
    return {"f": "f4", "d": "f8"}[kind]
