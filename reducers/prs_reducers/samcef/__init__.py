"""SAMCEF super-elements, from what a SAMCEF user can hand over."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import ClassVar

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.description.schema import Section
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.part_files import LabelledMatrices, NodeTable, read_text, super_element
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement

from ..tables.dof_table import DofTable, read_dof_table
from ..tables.mtx import is_mtx, parse_mtx
from .bacon import Deck, read_deck
from .dense import read_dense

__all__ = ["SamcefOptions", "SamcefReducer"]

logger = logging.getLogger("prs_model")

SAME_PLACE = 1e-6  # of the part's size


class SamcefOptions(Section):
    """Files beside the source, relative to its folder.

    dofs: what the rows are. mass: its own file; default: behind the stiffness in the source. deck: BACON data file with
    coordinates, groups, maybe units.
    """

    dofs: str
    mass: str | None = None
    deck: str | None = None


class SamcefReducer(Reducer[SamcefOptions]):
    """Reduced K and M with a table of their rows, and the BACON deck for coordinates, groups and units.

    No public description of SAMCEF's own super-element files exists, so none of them is read. Source: the stiffness, as
    Matrix Market or dense text with Fortran numbers, with the mass behind it or in a file of its own. The table is that
    of `dof_table`, its coordinates may be left to the deck. Where neither file names its matrices, nothing but the
    physics gate sees that K and M are exchanged.
    """

    description: ClassVar[str] = "SAMCEF: reduced K and M as text, table of rows, BACON deck for nodes and groups"
    Options: ClassVar[type[Section]] = SamcefOptions
    gives = "reduced"
    units = "optional"

    def read(self, part: PartRequest[SamcefOptions]) -> SuperElement:
        """The super-element; groups of the deck are its node sets, as far as their nodes are retained."""
        folder, options = part.path.parent, part.options
        table = read_dof_table(folder / options.dofs)
        deck = read_deck(folder / options.deck) if options.deck is not None else None
        units = _units(part, table, deck)
        stiffness, mass = _matrices(part.path, folder / options.mass if options.mass else None, len(table.nodes))
        matrices = LabelledMatrices(part.path, stiffness, mass, table.nodes, table.components)
        sets = {**_groups(table, deck), **table.node_sets}
        return super_element(matrices, _places(table, deck), units, modes=table.modes, node_sets=sets)

    def files(self, part: PartRequest[SamcefOptions]) -> tuple[Path, ...]:
        """The source, then the files that the options name."""
        named = (part.options.mass, part.options.dofs, part.options.deck)
        return (part.path, *(part.path.parent / name for name in named if name is not None))


def _units(part: PartRequest[SamcefOptions], table: DofTable, deck: Deck | None) -> Units:
    """What the request, the table and the deck say. Raises PartFileError when they differ, or none of them says."""
    units = table.units(part.units)
    if deck is None or deck.units is None:
        if units is None and deck is not None and deck.units_line:
            raise PartFileError(
                deck.source, f".UNIT '{deck.units_line}' is not understood: say 'units', such as mm-N-tonne-s"
            )
        return units or part.file_units
    if units not in (None, deck.units):
        other = "'units'" if part.units is not None else table.source.name
        raise PartFileError(deck.source, f".UNIT says '{deck.units_line}', and {other} something else: correct one")
    return deck.units


def _matrices(path: Path, mass_path: Path | None, rows: int) -> tuple[FloatArray, FloatArray]:
    if mass_path is not None:
        return _one(path, rows, "stiffness"), _one(mass_path, rows, "mass")
    text = read_text(path)
    if is_mtx(text):
        raise PartFileError(path, "holds one matrix, expected stiffness and mass: name the file of the mass as 'mass'")
    found = read_dense(text, path, rows)
    if len(found) != 2:
        raise PartFileError(path, f"holds {len(found)} matrices, expected stiffness and mass; or name 'mass' as a file")
    if set(found) not in ({"first", "second"}, {"stiffness", "mass"}):
        raise PartFileError(path, f"only one of its matrices says what it is ({', '.join(found)}): name both or none")
    return (found["stiffness"], found["mass"]) if "mass" in found else (found["first"], found["second"])


def _one(path: Path, rows: int, name: str) -> FloatArray:
    text = read_text(path)
    if is_mtx(text):
        return parse_mtx(text, path, rows).toarray()
    found = read_dense(text, path, rows)
    if list(found) not in (["first"], [name]):
        raise PartFileError(path, f"holds {', '.join(found) or 'no matrix'}, expected the {name} alone")
    return next(iter(found.values()))


def _places(table: DofTable, deck: Deck | None) -> NodeTable:
    """Coordinates of the table, else of the deck. Raises PartFileError when both have them and they differ."""
    if table.places is None:
        if deck is None or deck.nodes is None:
            raise PartFileError(
                table.source, "has no coordinates: write x, y, z after the component, or name a BACON file as 'deck'"
            )
        return deck.nodes
    if deck is not None and deck.nodes is not None:
        there = deck.nodes.coordinates[deck.nodes.places(table.places.labels, table.source)]
        size = np.ptp(deck.nodes.coordinates, axis=0).max()
        away = np.linalg.norm(there - table.places.coordinates, axis=1)
        if np.any(away > SAME_PLACE * size):
            node = table.places.labels[np.argmax(away)]
            raise PartFileError(
                table.source, f"node {node} is {away.max():.3g} away from where {deck.source.name} has it"
            )
    return table.places


def _groups(table: DofTable, deck: Deck | None) -> dict[str, tuple[str, ...]]:
    retained = {node for node, component in zip(table.nodes.tolist(), table.components, strict=True) if component >= 0}
    kept = {}
    for name, nodes in (deck.groups if deck is not None else {}).items():
        there = tuple(str(node) for node in nodes if str(node) in retained)
        if there:
            kept[name] = there
        if 0 < len(there) < len(nodes):
            logger.info("group %s: %d of its %d nodes are retained", name, len(there), len(nodes))
    return kept
