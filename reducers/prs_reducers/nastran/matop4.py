"""A part as EXTSEOUT(MATOP4) exports it: matrices in .op4, what their rows are in .pch (EXTRN) or .asm (SECONCT)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.errors import PartFileError
from prs_model.part_files import MODE, LabelledMatrices, NodeTable, read_apart
from prs_model.part_files.text import file_access

from .apart import EXTRA, NEEDS, READ_OP4
from .cards import BLANK, Card, read_cards
from .dmig import Dof
from .fortran import check_op4_text
from .geometry import Grid, System, check_points, grids_of, node_table, points_between, scalar_points, systems_of
from .notes import notes_of

ASSEMBLY = b"SE_START"  # the name of its first matrix
COMPONENTS = re.compile(r"0|(?!.*(.).*\1)[1-6]{1,6}")  # none twice
OTHER_SETS = ("ASET1", "BSET", "BSET1", "BNDFIX", "BNDFIX1", "BNDFREE", "BNDFREE1", "CSET", "CSET1")


@dataclass(frozen=True)
class Companion:
    """What one companion says. rows: of the matrices, in order; points: the same without components."""

    path: Path
    grids: Mapping[int, Grid]
    systems: Mapping[int, System]
    points: tuple[int, ...]
    rows: tuple[Dof, ...]
    names: Mapping[int, str]


def read_matop4(
    path: Path, companions: tuple[Path, ...], stiffness: str, mass: str
) -> tuple[LabelledMatrices, NodeTable, str]:
    """Matrices, points, and the output systems of turned points. companions: .pch and .asm, those that are there.

    Rows are in the order of EXTRN, else in that of SECONCT with six components to a grid. Where both files are there,
    they must agree. Raises PartFileError.
    """
    said = [_companion(each) for each in companions]
    for each in said[1:]:
        _check_agree(said[0], each)
    first = said[0]
    arrays = read_apart(READ_OP4, path, extra=EXTRA, needs=NEEDS, stiffness=stiffness, mass=mass)
    for kind, name in (("stiffness", stiffness), ("mass", mass)):
        _check_size(path, name.upper(), arrays[kind], first)
    matrices = LabelledMatrices(
        source=path,
        stiffness=arrays["stiffness"],
        mass=arrays["mass"],
        nodes=np.array([first.names.get(point, str(point)) for point, _ in first.rows], dtype=str),
        components=np.array([component - 1 if component else MODE for _, component in first.rows], dtype=np.int64),
    )
    turned = ", ".join(f"{point} in {grid.cd}" for point, grid in first.grids.items() if grid.cd)
    return matrices, node_table(first.path, first.grids, first.systems, first.names), turned


def check_beginning(path: Path) -> None:
    """Raises PartFileError for text that is no OP4, and for the .op4 of a nas2cam assembly, of several parts."""
    with file_access(path, "read"), path.open("rb") as file:
        head = file.read(128)
    if ASSEMBLY in head:
        source = path.with_suffix(".op2").name
        raise PartFileError(path, f"it is the .op4 of a nas2cam assembly: give {source} as the source, which finds it")
    if b"\0" not in head and head.strip():
        try:
            check_op4_text(head)
        except ValueError as error:
            raise PartFileError(path, str(error)) from error


def _check_size(path: Path, name: str, matrix: FloatArray, companion: Companion) -> None:
    n, rows = len(matrix), len(companion.rows)
    if n == rows:
        return
    if n == 1:
        raise PartFileError(path, f"{name} is 1x1, which stands for a matrix that the run did not write: export it")
    hint = "take the companions of the same export"
    if companion.path.suffix.lower() == ".asm":
        hint += "; where grids keep fewer than six components, the .pch is needed too"
    raise PartFileError(path, f"{name} is {n}x{n}, but {companion.path.name} names {rows} rows: {hint}")


def _companion(path: Path) -> Companion:
    cards = read_cards(path)
    grids = grids_of(cards)
    extrn = [card for card in cards if card.name == "EXTRN"]
    seconct = [card for card in cards if card.name == "SECONCT"]
    if extrn:
        rows = tuple(dof for card in extrn for dof in _dofs(card))
        _check_retained(path, cards, rows)
    elif seconct:
        rows = tuple(dof for card in seconct for point in _connected(card) for dof in _all_dofs(point, grids))
    else:
        raise PartFileError(path, "it has neither EXTRN nor SECONCT entries, which name the rows: export it again")
    points = tuple(dict.fromkeys(point for point, _ in rows))
    check_points(path, rows, grids, scalar_points(cards))
    return Companion(path, grids, systems_of(cards), points, rows, notes_of(path).names)


def _all_dofs(point: int, grids: Mapping[int, Grid]) -> list[Dof]:
    return [(point, component) for component in range(1, 7)] if point in grids else [(point, 0)]


def _dofs(card: Card) -> list[Dof]:
    """Points and components of an entry of pairs such as EXTRN, ``3, 123456``."""
    found: list[Dof] = []
    filled = max((index for index, text in enumerate(card.fields) if text != BLANK), default=-1)
    for at in range(0, filled + 1, 2):
        point, components = card.integer(at), str(card.integer(at + 1, 0))
        if point < 1 or not COMPONENTS.fullmatch(components):
            raise card.wrong(f"found {point}, {components}, expected a point and its components, such as 3, 123456")
        found.extend((point, int(component)) for component in sorted(components))
    return found


def _connected(card: Card) -> list[int]:
    """The points of the first superelement, which SECONCT pairs with those of the second from its ninth field on.

    Pairs ``a, c`` and pairs of ranges ``a, THRU, b, c, THRU, d`` may follow one another.
    """
    places = [index for index in range(8, len(card.fields)) if card.fields[index] != BLANK]
    found: list[int] = []
    while places:
        in_ranges = len(places) > 1 and card.text(places[1]) == "THRU"
        size = 6 if in_ranges else 2
        if len(places) < size:
            raise card.wrong("its last point is not paired: a line is missing or damaged")
        start = card.integer(places[0])
        found.extend(points_between(card, start, card.integer(places[2])) if in_ranges else [start])
        del places[:size]
    return found


def _check_retained(path: Path, cards: list[Card], rows: tuple[Dof, ...]) -> None:
    """EXTRN against ASET, which repeats it, unless other entries retain components too."""
    kept = {dof for card in cards if card.name == "ASET" for dof in _dofs(card)}
    if kept and not any(card.name in OTHER_SETS for card in cards):
        differing = {dof for dof in kept ^ set(rows) if dof[1]}
        if differing:
            point, component = min(differing)
            raise PartFileError(path, f"EXTRN and ASET differ at {point}.{component}: a line is missing or damaged")


def _check_agree(first: Companion, second: Companion) -> None:
    """Raises PartFileError when two companions are not of one export."""
    pair = f"{first.path.name} and {second.path.name}"
    if first.points != second.points:
        raise PartFileError(first.path, f"{pair} name different points: take the companions of the same export")
    for what, ours, theirs in (("point", first.grids, second.grids), ("system", first.systems, second.systems)):
        for number in ours.keys() & theirs.keys():
            if ours[number] != theirs[number]:
                raise PartFileError(
                    first.path, f"{pair} differ in {what} {number}: one of them is damaged or of another export"
                )
