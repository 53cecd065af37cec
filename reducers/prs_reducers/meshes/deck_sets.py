"""Node and element sets of a keyword deck, by name and by the part they stand in."""

from __future__ import annotations

import logging
from collections.abc import Mapping

import numpy as np

from prs_model.arrays import IntArray
from prs_model.errors import short

from .keyword_deck import Card, Fields

logger = logging.getLogger("prs_model")

Sets = dict[tuple[str, str], tuple[str, list[int]]]
"""By scope and name in capitals: the name as spelled, and its members."""


def add(sets: Sets, card: Card, name: str, members: list[int]) -> None:
    """Add members to a set, which may be there already."""
    plain = name.strip('"')
    sets.setdefault((card.scope, plain.upper()), (plain, []))[1].extend(members)


def looked_up(card: Card, line: int, known: Sets, name: str) -> list[int]:
    """Members of the set of that name in the card's scope, or else in any. Raises PartFileError."""
    upper = name.strip('"').rpartition(".")[2].upper()
    scopes = [scope for scope, key in known if key == upper]
    if not scopes:
        raise card.error(line, f"*{card.keyword}: found set '{short(name, 40)}', which the deck does not define before")
    return known[card.scope if card.scope in scopes else scopes[0], upper][1]


def members_of(card: Card, known: Sets, numbered: Mapping[int, int], what: str) -> list[int]:
    """What the data lines of a set name: labels (an instance's name may stand before them), and earlier sets.

    numbered: what a label stands for. A generated set leaves out labels that are none, as the solvers do. A label
    named twice is logged as a warning.
    """
    found: list[int] = []
    seen: set[str] = set()
    for line, fields in card.data:
        if "GENERATE" in card.options:
            first, last, step = _generated(card, line, fields)
            found += [of for label, of in numbered.items() if first <= label <= last and (label - first) % step == 0]
            continue
        for each in filter(None, fields):
            label = each.rpartition(".")[2]
            if label.isdigit() and each in seen:
                logger.warning("%s, line %d: %s %s is twice in one set", card.file.name, line, what, label)
            seen.add(each)
            if not label.isdigit():
                found += looked_up(card, line, known, each)
            elif int(label) in numbered:
                found.append(numbered[int(label)])
            else:
                raise card.error(line, f"*{card.keyword}: found {what} {label}, which the deck does not define")
    return found


def _generated(card: Card, line: int, fields: Fields) -> tuple[int, int, int]:
    first, last, step = ([card.whole(line, field) for field in fields if field] + [1, 1, 1])[:3]
    if len(fields) < 2 or step < 1 or last < first:
        raise card.error(line, f"*{card.keyword}: found {', '.join(fields)}, expected first, last and step")
    return first, last, step


def named(sets: Sets) -> dict[str, IntArray]:
    """Members by name, without empty sets; of one name in several scopes a part's are called ``<part>.<name>``."""
    names = [upper for _, upper in sets]
    return {
        f"{scope}.{name}" if scope and names.count(upper) > 1 else name: np.unique(np.array(members, dtype=np.int64))
        for (scope, upper), (name, members) in sets.items()
        if members
    }
