"""Elements of a keyword deck: their nodes, their sets, and which of them have mass."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from prs_model.arrays import IntArray

from .deck_sets import Sets, add, looked_up, members_of
from .keyword_deck import Card, Fields
from .solid_faces import CORNERS

SOLID = re.compile(r"C3D(\d+)")
WITH_MASS = re.compile(r"S[34689]|STRI|SC[68]|B[23][1-3]|PIPE[23]|ELBOW|T[23]D|M3D|MASS")
"""Types of elements other than solids that have mass: shells, beams, trusses, membranes, point masses."""
ON_ONE_LINE = 15
"""Most nodes that stand on one line with the element's label."""


@dataclass(frozen=True)
class Element:
    """kind: its type, in capitals. solid: a tetrahedron, wedge or brick. nodes: places in the node table."""

    kind: str
    solid: bool
    nodes: tuple[int, ...]


def elements_of(cards: list[Card], place: Mapping[int, int]) -> dict[int, Element]:
    """Elements by label; place: of each node's label in the table. Raises PartFileError."""
    elements: dict[int, Element] = {}
    for card in cards:
        if card.keyword != "ELEMENT":
            continue
        kind = card.option("TYPE").upper()
        for line, label, nodes in _joined(card):
            strangers = [node for node in nodes if node not in place]
            if strangers:
                raise card.error(line, f"element {label} has node {strangers[0]}, which the deck does not define")
            if label in elements:
                raise card.error(line, f"element {label} is defined twice")
            elements[label] = Element(kind, _node_count(card) in CORNERS, tuple(place[node] for node in nodes))
    return elements


def _node_count(card: Card) -> int:
    """Number of nodes of a solid element's type; 0 for all others."""
    found = SOLID.match(card.option("TYPE").upper())
    return int(found[1]) if found else 0


def _joined(card: Card) -> Iterator[tuple[int, int, list[int]]]:
    """Line, label and nodes of each element, which may go on over lines that end in a comma or are full."""
    count, fields = _node_count(card), Fields()
    for line, more in card.data:
        fields += tuple(field for field in more if field)
        if len(fields) < count + 1 and (count > ON_ONE_LINE or not more[-1]):
            continue
        if more[-1] or len(fields) == count + 1:
            if count and len(fields) != count + 1:
                raise card.error(line, f"found {len(fields) - 1} nodes, expected {count} for {card.option('TYPE')}")
            label, *nodes = (card.whole(line, field) for field in fields)
            yield line, label, nodes
            fields = ()
    if fields:
        raise card.error(card.data[-1][0], f"an element of {len(fields) - 1} nodes, expected {count}: truncated")


def solids_of(elements: Mapping[int, Element]) -> dict[int, IntArray]:
    """Nodes (e, 4 to 20) of solid elements by their number of nodes."""
    solids: dict[int, list[tuple[int, ...]]] = {}
    for element in elements.values():
        if element.solid:
            solids.setdefault(len(element.nodes), []).append(element.nodes)
    return {count: np.array(nodes, dtype=np.int64) for count, nodes in solids.items()}


def others_of(elements: Mapping[int, Element]) -> IntArray:
    """(m,) nodes of all elements that are not solid."""
    return np.array(sorted({n for each in elements.values() if not each.solid for n in each.nodes}), dtype=np.int64)


def element_sets(cards: list[Card], elements: Mapping[int, Element]) -> Sets:
    """Labels of elements by set."""
    sets: Sets = {}
    itself = {label: label for label in elements}
    for card in cards:
        if card.keyword == "ELEMENT" and card.options.get("ELSET"):
            add(sets, card, card.options["ELSET"], [label for _, label, _ in _joined(card)])
        elif card.keyword == "ELSET":
            add(sets, card, card.option("ELSET"), members_of(card, sets, itself, "element"))
    return sets


def weighing(cards: list[Card], elements: Mapping[int, Element], members: Sets) -> IntArray:
    """(m,) nodes of elements that are not solid and have mass: their type has, and so has their section's material."""
    light = _materials_without_density(cards)
    without: set[int] = set()
    for card in cards:
        if card.keyword.endswith(" SECTION") and card.options.get("ELSET") and _is_light(card, light):
            without.update(looked_up(card, card.line, members, card.options["ELSET"]))
    heavy = (each for label, each in elements.items() if label not in without and WITH_MASS.match(each.kind))
    return np.array(sorted({node for each in heavy for node in each.nodes}), dtype=np.int64)


def _materials_without_density(cards: list[Card]) -> set[str]:
    names, current = set(), ""
    for card in cards:
        if card.keyword == "MATERIAL":
            current = card.option("NAME").strip('"').upper()
            names.add(current)
        elif card.keyword == "DENSITY":
            names.discard(current)
    return names


def _is_light(section: Card, materials: set[str]) -> bool:
    material = section.options.get("MATERIAL", "").strip('"').upper()
    if not material and "GENERAL" in section.keyword:
        return "DENSITY" not in section.options
    return material in materials
