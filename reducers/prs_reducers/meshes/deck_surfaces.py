"""Surfaces of a keyword deck: faces of solid elements, and surfaces that are mere sets of nodes."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from prs_model.arrays import IntArray

from .deck_elements import Element
from .deck_sets import Sets, add, members_of
from .keyword_deck import Card, Fields
from .solid_faces import CORNERS, FACES, face_nodes

Faces = list[tuple[IntArray, IntArray]]
"""Corners (f, 3 or 4) and mid-side nodes (f, 0, 3 or 4) of faces, those of one shape together."""
FREE = ""
"""What stands for the label of a face where a line has none: all faces that no other element has."""

logger = logging.getLogger("prs_model")


def surfaces_of(cards: list[Card], elements: Mapping[int, Element], members: Sets) -> dict[str, Faces]:
    """Faces of solid elements by the surface's name; sides of shells and beams are left out. Raises PartFileError.

    An element or set without a face label stands for all its faces that no other element has, as Abaqus takes it.
    """
    cards = [card for card in _surfaces(cards, "ELEMENT") if not _of_surfaces(card)]
    sides = {_side(fields) for card in cards for _, fields in card.data}
    free = _free_faces(elements) if FREE in sides else {}
    numbered = {label: label for label in elements}
    surfaces = {}
    for card in cards:
        faces = Faces()
        for line, fields in card.data:
            one = replace(card, options={}, data=((line, fields[:1]),))
            for label in members_of(one, members, numbered, "element"):
                if elements[label].solid:
                    faces += _faces(one, _side(fields), label, elements[label], free)
        if faces:
            surfaces[card.option("NAME").strip('"')] = _by_shape(faces)
    return surfaces


def node_surfaces(cards: list[Card], sets: Sets, place: Mapping[int, int]) -> Sets:
    """Surfaces of TYPE=NODE: places of nodes by name."""
    found: Sets = {}
    for card in _surfaces(cards, "NODE"):
        nodes = replace(card, data=tuple((line, fields[:1]) for line, fields in card.data))
        add(found, card, card.option("NAME"), members_of(nodes, sets, place, "node"))
    return found


def _surfaces(cards: list[Card], kind: str) -> Iterator[Card]:
    return (card for card in cards if card.keyword == "SURFACE" and card.options.get("TYPE", "ELEMENT").upper() == kind)


def _free_faces(elements: Mapping[int, Element]) -> dict[int, list[int]]:
    """By label of a solid element: those of its faces 0, 1, .. that no other element has."""
    corners = {
        (label, face): frozenset(element.nodes[corner] for corner in around)
        for label, element in elements.items()
        if element.solid
        for face, around in enumerate(FACES[CORNERS[len(element.nodes)]])
    }
    count, free = Counter(corners.values()), dict[int, list[int]]()
    for (label, face), nodes in corners.items():
        if count[nodes] == 1:
            free.setdefault(label, []).append(face)
    return free


def _of_surfaces(card: Card) -> bool:
    """Whether it makes a surface of others, which is left out with a warning."""
    if not {"COMBINE", "CROP"} & set(card.options):
        return False
    logger.warning("%s, line %d: a *SURFACE made of other surfaces is not read", card.file.name, card.line)
    return True


def _side(fields: Fields) -> str:
    return fields[1].upper() if len(fields) > 1 else FREE


def _faces(line: Card, side: str, label: int, element: Element, free: Mapping[int, list[int]]) -> Faces:
    """The face ``S1`` .. of a solid element, or all its free ones. line: the card with one line of its data."""
    count = len(FACES[CORNERS[len(element.nodes)]])
    known = {f"S{face + 1}": [face] for face in range(count)} | {FREE: free.get(label, [])}
    if side not in known:
        text = f"*SURFACE: found side '{side}' of element {label}, a solid; expected S1 to S{count}"
        raise line.error(line.data[0][0], text)
    nodes = np.array([element.nodes], dtype=np.int64)
    return [face_nodes(nodes, face) for face in known[side]]


def _by_shape(faces: Faces) -> Faces:
    """Faces with as many corners and mid-side nodes as each other, in one pair of arrays."""
    shapes: dict[tuple[int, int], Faces] = {}
    for corners, middles in faces:
        shapes.setdefault((corners.shape[1], middles.shape[1]), []).append((corners, middles))
    return [(np.concatenate([c for c, _ in each]), np.concatenate([m for _, m in each])) for each in shapes.values()]
