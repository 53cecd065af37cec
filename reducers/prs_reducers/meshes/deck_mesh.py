"""The mesh of a keyword deck: nodes, elements, sets, surfaces, local axes and boundary conditions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prs_model.arrays import IntArray
from prs_model.part_files import NodeTable

from .deck_nodes import coordinates_of, local_frames
from .deck_sets import Sets, add, looked_up, members_of, named
from .keyword_deck import Card, Fields, read_cards
from .labelled_mesh import LabelledMesh
from .solid_faces import CORNERS, FACES, face_nodes

SOLID = re.compile(r"C3D(\d+)")
TIES = (
    *("TIE", "EQUATION", "MPC", "COUPLING", "KINEMATIC COUPLING", "DISTRIBUTING COUPLING", "SHELL TO SOLID COUPLING"),
    *("RIGID BODY", "CONTACT", "CONTACT PAIR", "EMBEDDED ELEMENT", "CYCLIC SYMMETRY MODEL", "MATRIX INPUT"),
)
HELD_BY_NAME = {"ENCASTRE": range(6), "PINNED": range(3)}


@dataclass(frozen=True)
class Element:
    """solid: a tetrahedron, wedge or brick. nodes: places in the node table."""

    solid: bool
    nodes: tuple[int, ...]


def read_deck_mesh(path: Path) -> LabelledMesh:
    """The mesh of a deck with all it includes. Raises PartFileError naming file and line."""
    cards = read_cards(path)
    labels, points = coordinates_of(cards)
    place = {label: index for index, label in enumerate(labels)}
    elements = _elements(cards, place)
    members = _element_sets(cards, elements)
    sets = _node_sets(cards, place, elements, members)
    frames = local_frames(cards, points, place, sets)
    return LabelledMesh(
        table=NodeTable(path, np.array(labels, dtype=np.int64), points, frames),
        solids=_solids(elements),
        others=np.array(
            sorted({n for each in elements.values() if not each.solid for n in each.nodes}), dtype=np.int64
        ),
        node_sets=named(_with_elements(sets, members, elements)),
        surfaces=_surfaces(cards, elements, members),
        held=_held(cards, place, sets),
        tied=any(card.keyword in TIES for card in cards),
    )


def _elements(cards: list[Card], place: Mapping[int, int]) -> dict[int, Element]:
    elements: dict[int, Element] = {}
    for card in cards:
        if card.keyword != "ELEMENT":
            continue
        for line, label, nodes in _joined(card):
            strangers = [node for node in nodes if node not in place]
            if strangers:
                raise card.error(line, f"element {label} has node {strangers[0]}, which the deck does not define")
            if label in elements:
                raise card.error(line, f"element {label} is defined twice")
            elements[label] = Element(_node_count(card) in CORNERS, tuple(place[node] for node in nodes))
    return elements


def _node_count(card: Card) -> int:
    """Number of nodes of a solid element's type; 0 for all others."""
    found = SOLID.match(card.option("TYPE").upper())
    return int(found[1]) if found else 0


def _joined(card: Card) -> Iterator[tuple[int, int, list[int]]]:
    """Line, label and nodes of each element, which may go on over lines that end in a comma."""
    count, fields = _node_count(card), Fields()
    for line, more in card.data:
        fields += tuple(field for field in more if field)
        if more[-1] or len(fields) == count + 1:
            if count and len(fields) != count + 1:
                raise card.error(line, f"found {len(fields) - 1} nodes, expected {count} for {card.option('TYPE')}")
            label, *nodes = (card.whole(line, field) for field in fields)
            yield line, label, nodes
            fields = ()
    if fields:
        raise card.error(card.data[-1][0], f"an element of {len(fields) - 1} nodes, expected {count}: truncated")


def _solids(elements: Mapping[int, Element]) -> dict[int, IntArray]:
    solids: dict[int, list[tuple[int, ...]]] = {}
    for element in elements.values():
        if element.solid:
            solids.setdefault(len(element.nodes), []).append(element.nodes)
    return {count: np.array(nodes, dtype=np.int64) for count, nodes in solids.items()}


def _element_sets(cards: list[Card], elements: Mapping[int, Element]) -> Sets:
    """Labels of elements by set."""
    sets: Sets = {}
    itself = {label: label for label in elements}
    for card in cards:
        if card.keyword == "ELEMENT" and card.options.get("ELSET"):
            add(sets, card, card.options["ELSET"], [label for _, label, _ in _joined(card)])
        elif card.keyword == "ELSET":
            add(sets, card, card.option("ELSET"), members_of(card, sets, itself, "element"))
    return sets


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


def _with_elements(sets: Sets, members: Sets, elements: Mapping[int, Element]) -> Sets:
    """Node sets, and the nodes of element sets whose names no node set has; not the helpers of surfaces (``_..``)."""
    taken = {upper for _, upper in sets}
    of_elements = {
        key: (name, [node for label in labels for node in elements[label].nodes])
        for key, (name, labels) in members.items()
        if key[1] not in taken and not name.startswith("_")
    }
    return sets | of_elements


def _surfaces(
    cards: list[Card], elements: Mapping[int, Element], members: Sets
) -> dict[str, list[tuple[IntArray, IntArray]]]:
    surfaces = {}
    for card in cards:
        if card.keyword == "SURFACE" and card.options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            faces = [face for line, fields in card.data for face in _faces(card, line, fields, elements, members)]
            if faces:
                surfaces[card.option("NAME").strip('"')] = _by_shape(faces)
    return surfaces


def _by_shape(faces: list[tuple[IntArray, IntArray]]) -> list[tuple[IntArray, IntArray]]:
    """Faces with as many corners and mid-side nodes as each other, in one pair of arrays."""
    shapes: dict[tuple[int, int], list[tuple[IntArray, IntArray]]] = {}
    for corners, middles in faces:
        shapes.setdefault((corners.shape[1], middles.shape[1]), []).append((corners, middles))
    return [(np.concatenate([c for c, _ in each]), np.concatenate([m for _, m in each])) for each in shapes.values()]


def _faces(
    card: Card, line: int, fields: Fields, elements: Mapping[int, Element], members: Sets
) -> Iterator[tuple[IntArray, IntArray]]:
    """The faces ``S1`` .. of an element or of all in a set; other sides (of shells and beams) are left out."""
    if len(fields) < 2 or not re.fullmatch(r"[sS][1-6]", fields[1]):
        return
    numbered = {label: label for label in elements}
    one = Card(card.file, card.line, card.keyword, {}, ((line, fields[:1]),), card.scope)
    for label in members_of(one, members, numbered, "element"):
        element, face = elements[label], int(fields[1][1]) - 1
        if element.solid and face < len(FACES[CORNERS[len(element.nodes)]]):
            yield face_nodes(np.array([element.nodes], dtype=np.int64), face)


def _held(cards: list[Card], place: Mapping[int, int], sets: Sets) -> IntArray:
    held: set[tuple[int, int]] = set()
    for card in cards:
        if card.keyword != "BOUNDARY":
            continue
        for line, fields in card.data:
            one = Card(card.file, card.line, card.keyword, {}, ((line, fields[:1]),), card.scope)
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
