"""DMIG matrices: entries with a point and component on either side, as punches and EXTDB data blocks hold them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csr_array

from prs_model.errors import PartFileError
from prs_model.part_files import MODE, LabelledMatrices

from .cards import BLANK, Card

SQUARE, RECTANGULAR, SYMMETRIC, COUNTED = 1, 2, 6, 9
FORMS = (SQUARE, RECTANGULAR, SYMMETRIC, COUNTED)
REAL = (1, 2)

Dof = tuple[int, int]
"""A point's number with its component 1..6, or 0 for a scalar point (of form 9: a column's number, and 0 or 1)."""


@dataclass
class Dmig:
    """One matrix as it is stored. kind: 1 or 2 real, 3 or 4 complex. columns: as stated, None or 0 where not (only
    form 9 has to).
    """

    source: Path
    name: str
    form: int
    kind: int
    columns: int | None
    entries: dict[tuple[Dof, Dof], complex] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.form not in FORMS or self.kind not in (1, 2, 3, 4):
            raise self.wrong(f"has form {self.form} and type {self.kind}, expected form 1, 2, 6 or 9 and type 1 to 4")

    def wrong(self, message: str) -> PartFileError:
        """The error to raise for this matrix."""
        return PartFileError(self.source, f"matrix {self.name} {message}")

    def put(self, row: Dof, column: Dof, value: complex) -> None:
        """Add an entry. Raises PartFileError for one that is there, or whose mirror is there of a symmetric matrix."""
        if row[0] < 1 or not 0 <= row[1] <= 6 or column[0] < 1 or not 0 <= column[1] <= 6:
            raise self.wrong(f"has an entry at {_said(row)}, {_said(column)}, expected points with components 0 to 6")
        twice = (row, column) in self.entries or (
            self.form == SYMMETRIC and row != column and (column, row) in self.entries
        )
        if twice:
            raise self.wrong(f"has two entries at {_said(row)}, {_said(column)}")
        if not np.isfinite(value):
            raise self.wrong(f"has a number that is not finite at {_said(row)}, {_said(column)}")
        self.entries[row, column] = value

    def rows(self) -> list[Dof]:
        """Points and components of the rows that have entries; of a square matrix, of the columns too."""
        found = {row for row, _ in self.entries}
        return sorted(found | set(self._columns()) if self.form in (SQUARE, SYMMETRIC) else found)

    def _columns(self) -> list[Dof]:
        return sorted({column for _, column in self.entries})

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns that have entries."""
        if self.form in (SQUARE, SYMMETRIC):
            return len(self.rows()), len(self.rows())
        return len(self.rows()), len(self._columns())

    def check(self) -> None:
        """Raises PartFileError for an empty matrix, or one of more columns than stated."""
        if not self.entries:
            raise self.wrong("has no entries: the file is truncated, or the run wrote none")
        if self.columns and len(self._columns()) > self.columns:
            raise self.wrong(f"has {len(self._columns())} columns, but states {self.columns}")

    def square(self, dofs: list[Dof]) -> csr_array:
        """(n, n) with rows and columns in the order of `dofs`. Raises PartFileError unless it is real and square."""
        if self.form not in (SQUARE, SYMMETRIC) or self.kind not in REAL:
            what = "complex" if self.kind not in REAL else "rectangular"
            raise self.wrong(f"is {what} (form {self.form}, type {self.kind}), expected a real square one")
        place = {dof: index for index, dof in enumerate(dofs)}
        n = len(dofs)
        rows = np.array([place[row] for row, _ in self.entries])
        columns = np.array([place[column] for _, column in self.entries])
        values = np.array([value.real for value in self.entries.values()])
        matrix = csr_array(coo_array((values, (rows, columns)), shape=(n, n)))
        if self.form == SYMMETRIC:
            matrix = csr_array(matrix + matrix.T)
            matrix.setdiag(matrix.diagonal() / 2.0)
        return matrix


def dmig_matrices(cards: Iterable[Card]) -> dict[str, Dmig]:
    """Every DMIG matrix of a bulk data file by its name, in upper case. Raises PartFileError for what is none."""
    found: dict[str, Dmig] = {}
    for card in cards:
        if card.name != "DMIG":
            continue
        name = card.text(0).upper()
        if card.integer(1) == 0:
            if name in found:
                raise card.wrong(f"matrix {name} begins twice")
            columns = card.integer(7) if card.text(7) != BLANK else None
            found[name] = Dmig(card.path, name, card.integer(2), card.integer(3), columns)
        elif name in found:
            _put_column(found[name], card)
        else:
            raise card.wrong(f"a column of {name or 'no name'}, whose header (DMIG {name} 0 ..) is not before it")
    for matrix in found.values():
        matrix.check()
    return found


def _put_column(matrix: Dmig, card: Card) -> None:
    column = card.integer(1), card.integer(2, 0)
    for at in _groups(card):
        imaginary = card.real(at + 3, 0.0)
        if matrix.kind in REAL and imaginary != 0.0:
            raise card.wrong(f"field {at + 5} is an imaginary part, but {matrix.name} is real")
        matrix.put((card.integer(at), card.integer(at + 1, 0)), column, complex(card.real(at + 2), imaginary))


def _groups(card: Card) -> list[int]:
    """Where each entry of a column begins. Raises PartFileError for a column whose first entry is blank."""
    groups = [at for at in range(4, len(card.fields), 4) if any(card.fields[at : at + 4])]
    if groups[:1] != [4]:
        raise card.wrong("a column whose first entry is blank: a line is missing")
    return groups


def labelled(
    matrices: dict[str, Dmig], stiffness: str, mass: str, names: Mapping[int, str], path: Path
) -> tuple[LabelledMatrices, list[Dof]]:
    """Stiffness and mass on all points that either names, scalar points as modes; and what their rows are.

    Raises PartFileError.
    """
    pair = [_named(matrices, kind, name.upper(), path) for kind, name in (("stiffness", stiffness), ("mass", mass))]
    dofs = sorted(set(pair[0].rows()) | set(pair[1].rows()))
    found = LabelledMatrices(
        source=path,
        stiffness=pair[0].square(dofs),
        mass=pair[1].square(dofs),
        nodes=np.array([names.get(point, str(point)) for point, _ in dofs], dtype=str),
        components=np.array([component - 1 if component else MODE for _, component in dofs], dtype=np.int64),
    )
    return found, dofs


def _named(matrices: dict[str, Dmig], kind: str, name: str, path: Path) -> Dmig:
    if name not in matrices:
        listed = ", ".join(matrices)
        raise PartFileError(
            path, f"it has no {kind} matrix {name}, only {listed}: export it too, or name it with option '{kind}'"
        )
    return matrices[name]


def _said(dof: Dof) -> str:
    return f"{dof[0]}.{dof[1]}"
