"""The mesh of a keyword deck: nodes, elements, sets, surfaces, local axes and boundary conditions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from prs_model.arrays import IntArray
from prs_model.part_files import NodeTable

from .deck_elements import Element, element_sets, elements_of, others_of, solids_of, weighing
from .deck_nodes import coordinates_of, local_frames
from .deck_sets import Sets, add, looked_up, members_of, named
from .deck_surfaces import node_surfaces, surfaces_of
from .keyword_deck import Card, Fields, read_cards
from .labelled_mesh import LabelledMesh

TIES = (
    *("TIE", "EQUATION", "MPC", "COUPLING", "KINEMATIC COUPLING", "DISTRIBUTING COUPLING", "SHELL TO SOLID COUPLING"),
    *("RIGID BODY", "CONTACT", "CONTACT PAIR", "EMBEDDED ELEMENT", "CYCLIC SYMMETRY MODEL", "MATRIX INPUT"),
)
HELD_BY_NAME = {
    "ENCASTRE": (0, 1, 2, 3, 4, 5),
    "PINNED": (0, 1, 2),
    "XSYMM": (0, 4, 5),
    "YSYMM": (1, 3, 5),
    "ZSYMM": (2, 3, 4),
    "XASYMM": (1, 2, 3),
    "YASYMM": (0, 2, 4),
    "ZASYMM": (0, 1, 5),
}


def read_deck_mesh(path: Path) -> LabelledMesh:
    """The mesh of a deck with all it includes. Raises PartFileError naming file and line."""
    cards = read_cards(path)
    labels, points = coordinates_of(cards)
    place = {label: index for index, label in enumerate(labels)}
    elements = elements_of(cards, place)
    members = element_sets(cards, elements)
    sets = _node_sets(cards, place, elements, members)
    frames = local_frames(cards, points, place, sets)
    return LabelledMesh(
        table=NodeTable(path, np.array(labels, dtype=np.int64), points, frames),
        solids=solids_of(elements),
        others=others_of(elements),
        weighing=weighing(cards, elements, members),
        node_sets=named(_with_others(sets, node_surfaces(cards, sets, place), _nodes_of(members, elements))),
        surfaces=surfaces_of(cards, elements, members),
        held=_held(cards, place, sets),
        tied=any(card.keyword in TIES for card in cards),
    )


def _node_sets(cards: list[Card], place: Mapping[int, int], elements: Mapping[int, Element], members: Sets) -> Sets:
    """Places of nodes by set."""
    sets: Sets = {}
    for card in cards:
        if card.keyword == "NODE" and card.options.get("NSET"):
            add(sets, card, card.options["NSET"], [place[int(fields[0])] for _, fields in card.data])
        elif card.keyword == "NSET" and card.options.get("ELSET"):
            labels = looked_up(card, card.line, members, card.options["ELSET"])
            add(sets, card, card.option("NSET"), [node for label in labels for node in elements[label].nodes])
        elif card.keyword == "NSET":
            add(sets, card, card.option("NSET"), members_of(card, sets, place, "node"))
    return sets


def _nodes_of(members: Sets, elements: Mapping[int, Element]) -> Sets:
    """The nodes of element sets; not of the helpers of surfaces (``_..``)."""
    return {
        key: (name, [node for label in labels for node in elements[label].nodes])
        for key, (name, labels) in members.items()
        if not name.startswith("_")
    }


def _with_others(sets: Sets, *others: Sets) -> Sets:
    """Node sets, and those of the others whose names none before them has."""
    for other in others:
        taken = {upper for _, upper in sets}
        sets = sets | {key: named for key, named in other.items() if key[1] not in taken}
    return sets


def _held(cards: list[Card], place: Mapping[int, int], sets: Sets) -> IntArray:
    held: set[tuple[int, int]] = set()
    for card in cards:
        if card.keyword != "BOUNDARY":
            continue
        for line, fields in card.data:
            one = replace(card, options={}, data=((line, fields[:1]),))
            components = _components(card, line, fields[1:])
            held.update((node, component) for node in members_of(one, sets, place, "node") for component in components)
    return np.array(sorted(held), dtype=np.int64).reshape(-1, 2)


def _components(card: Card, line: int, fields: Fields) -> Iterable[int]:
    """The components 0..5 of ``first, last`` or of a name such as ENCASTRE."""
    if fields and fields[0].upper() in HELD_BY_NAME:
        return HELD_BY_NAME[fields[0].upper()]
    first = card.whole(line, fields[0] if fields else "")
    last = card.whole(line, fields[1]) if len(fields) > 1 and fields[1] else first
    return range(first - 1, min(last, 6))
