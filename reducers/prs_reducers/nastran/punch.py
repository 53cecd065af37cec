"""A part as DMIG punch: stiffness and mass, with GRID entries beside them or in another bulk data file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from prs_model.errors import PartFileError
from prs_model.part_files import LabelledMatrices, NodeTable

from .cards import Card, read_cards
from .dmig import Dmig, Dof, dmig_matrices, labelled
from .geometry import check_points, grids_of, node_table, scalar_points, systems_of
from .notes import notes_of


def punch_matrices(path: Path) -> dict[str, Dmig]:
    """Every DMIG matrix of a punch by name. Raises PartFileError when there is none."""
    return _matrices(path, read_cards(path))


def read_punch(path: Path, grids: Path | None, stiffness: str, mass: str) -> tuple[LabelledMatrices, NodeTable]:
    """Stiffness and mass of a DMIG punch. grids: bulk data with its GRID and CORD2 entries, where it has none itself.

    A punch has no count of its entries, so a cut at the end of a line can go unseen here; the physics gate sees the
    mass that is missing. Raises PartFileError.
    """
    cards = read_cards(path)
    matrices = _matrices(path, cards)
    names = notes_of(path).names
    found, rows = labelled(matrices, stiffness, mass, names, path)
    return found, grid_table(path, cards, grids, names, rows)


def grid_table(
    path: Path, cards: list[Card], grids: Path | None, names: Mapping[int, str], rows: Iterable[Dof]
) -> NodeTable:
    """The grid points among these entries, or of the file `grids`, which both say what kind of point each row is of.

    Raises PartFileError when there are none, or a row is of another kind.
    """
    source, entries = (path, cards) if grids is None else (grids, read_cards(grids))
    found = grids_of(entries)
    if not found:
        hint = "name the bulk data file that has them with option 'grids'" if grids is None else "name another file"
        raise PartFileError(source, f"it has no GRID entries, so that its points have no places: {hint}")
    check_points(source, rows, found, scalar_points(cards) | scalar_points(entries) or None)
    return node_table(source, found, systems_of(entries), names)


def _matrices(path: Path, cards: list[Card]) -> dict[str, Dmig]:
    found = dmig_matrices(cards)
    if not found:
        companion = any(card.name in ("EXTRN", "SECONCT") for card in cards)
        hint = (
            "it is the companion of an EXTSEOUT export: give the .op4" if companion else "export DMIG, or give the .op4"
        )
        raise PartFileError(path, f"it has no DMIG entries: {hint}")
    return found
